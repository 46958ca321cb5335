//! New vertices: walks from either end of a path, and the joint between them.

use super::node::Node;
use super::numbers::Numbers;
use super::path::Path;
use super::world::World;
use crate::geometry::{Ray, SurfacePoint};
use crate::material::Quantity;
use crate::path::{Kind, Surface};
use crate::spectrum::Wavelengths;
use glam::Vec3A;

/// The number that chooses the lobe of transmission, or of reflection, wherever there is one.
pub const fn lobe_number(crosses: bool) -> f32 {
    if crosses { 1.0 - f32::EPSILON / 2.0 } else { 0.0 }
}

/// Vertices of a walk that are not left to chance, and the probability of each one after them:
/// light that is trapped between mirrors ends.
pub const SURE_VERTICES: usize = 32;
/// See [`SURE_VERTICES`].
pub const SURVIVAL: f64 = 0.98;

/// How far a walk goes.
#[derive(Clone, Copy)]
pub enum Until {
    /// To so many vertices.
    Vertices(usize),
    /// To so many that count.
    Counted(usize),
}

impl Until {
    fn is_reached(self, walk: &[Node]) -> bool {
        match self {
            Self::Vertices(vertices) => walk.len() >= vertices,
            Self::Counted(vertices) => walk.iter().filter(|node| node.counts()).count() >= vertices,
        }
    }

    /// The same for one vertex less.
    const fn before(self) -> Self {
        match self {
            Self::Vertices(vertices) => Self::Vertices(vertices.saturating_sub(1)),
            Self::Counted(vertices) => Self::Counted(vertices.saturating_sub(1)),
        }
    }

    const fn vertices(self) -> usize {
        match self {
            Self::Vertices(vertices) | Self::Counted(vertices) => vertices,
        }
    }
}

/// Whether a walk of so many vertices gets another one.
pub fn survives(walk: &[Node], numbers: &mut Numbers) -> bool {
    walk.len() < SURE_VERTICES || numbers.fine() < SURVIVAL
}

/// Where the numbers of a walk come from.
pub trait Source {
    /// Which way a surface sends light, and where exactly: by [`crate::material::Bsdf::sample`].
    fn scatter(&mut self) -> (f32, [f32; 2]);
}

impl Source for Numbers {
    fn scatter(&mut self) -> (f32, [f32; 2]) {
        (self.single(), self.pair())
    }
}

/// Vertices while they are being found.
#[derive(Debug, Default)]
pub struct Draft {
    /// From the light on.
    pub light: Vec<Node>,
    /// From the eye on.
    pub eye: Vec<Node>,
}

impl Draft {
    /// Keeps the first vertices of a path and its last ones.
    pub fn keep(&mut self, path: &Path, from_light: usize, from_eye: usize) {
        self.light.clear();
        self.light.extend_from_slice(&path.nodes[..from_light]);
        self.eye.clear();
        self.eye.extend(path.nodes[path.count() - from_eye..].iter().rev());
    }

    /// Vertices found.
    pub const fn vertices(&self) -> u64 {
        (self.light.len() + self.eye.len()) as u64
    }

    /// Puts the vertices together.
    pub fn finish(&self, path: &mut Path) {
        path.nodes.clear();
        path.nodes.extend_from_slice(&self.light);
        path.nodes.extend(self.eye.iter().rev());
    }
}

impl World<'_> {
    /// The vertex that a ray meets; `None` where it leaves the scene.
    pub fn meet(&self, ray: &Ray, wavelengths: &Wavelengths) -> Option<Node> {
        let hit = self.scene.geometry.intersect(ray)?;
        let kind = Kind::Surface(Surface::of(self.scene, &hit, wavelengths));
        Some(Node { point: hit.point, kind, is_delta: false })
    }

    /// Whether nothing stands between two vertices.
    pub fn sees(&self, a: &Node, b: &Node) -> bool {
        a.point.ray_to(&b.point).is_some_and(|ray| !self.scene.geometry.occluded(&ray))
    }

    /// A position anywhere in the picture.
    pub fn any_position(&self, numbers: &mut Numbers) -> [f64; 2] {
        self.resolution.map(|side| numbers.fine() * f64::from(side))
    }

    /// A point of the eye.
    pub fn eye_node(&self, numbers: &mut Numbers) -> Option<Node> {
        let aperture = self.eye.has_aperture();
        let u_lens = if aperture { numbers.pair() } else { [0.5; 2] };
        Some(Node::eye(self.eye.point(u_lens)?, aperture))
    }

    /// The ray from a point of the eye that is recorded at a position.
    pub fn eye_ray(&self, eye: &Node, position: [f64; 2]) -> Option<Ray> {
        self.eye.ray_from(&eye.point, position)
    }

    /// A point of a light, as the start of a walk.
    pub fn start_of_light(&self, numbers: &mut Numbers) -> Option<Node> {
        let (index, _) = self.scene.lights.choose_emitting(numbers.fine())?;
        let light = self.scene.lights.get(index);
        let emitted = light.emit(&self.scene.geometry, numbers.pair(), [0.5; 2])?;
        Some(Node::light(emitted.point, index, emitted.primitive))
    }

    /// A point of a light that a vertex asks for.
    pub fn asked_light(
        &self,
        from: &SurfacePoint,
        wavelengths: &Wavelengths,
        numbers: &mut Numbers,
    ) -> Option<Node> {
        let (index, _) = self.scene.lights.choose_towards(from.position, numbers.fine())?;
        let light = self.scene.lights.get(index);
        let sample = light.sample_towards(&self.scene.geometry, from, numbers.pair(), wavelengths)?;
        Some(Node::light(sample.point, index, sample.primitive))
    }

    /// A ray that leaves a light's point.
    pub fn light_ray(&self, node: &Node, u: [f32; 2]) -> Option<Ray> {
        let Kind::Light { light, .. } = node.kind else { return None };
        let direction = self.scene.lights.get(light).direction_from(node.point.normal, u);
        Some(node.point.ray_along(direction))
    }

    /// The ray on which a surface sends a walk that came from a neighbour's position.
    pub fn scattered_ray(
        &self,
        node: &mut Node,
        from: &Node,
        (u_lobe, u): (f32, [f32; 2]),
        quantity: Quantity,
    ) -> Option<Ray> {
        let surface = node.surface()?;
        let back = (from.point.position.as_dvec3() - node.point.position.as_dvec3()).normalize().as_vec3a();
        let wo = surface.shading.to_local(back);
        let drawn = surface.bsdf.sample(wo, u_lobe, u, quantity)?;
        let direction: Vec3A = surface.shading.to_world(drawn.wi).normalize();
        if !surface.sides_agree(&node.point, back) || !surface.sides_agree(&node.point, direction) {
            return None;
        }
        let ray = node.point.ray_along(direction);
        node.is_delta = drawn.is_delta;
        Some(ray)
    }

    /// Walks on from the eye's side.
    pub fn walk_from_eye(
        &self,
        draft: &mut Draft,
        until: Until,
        wavelengths: &Wavelengths,
        numbers: &mut Numbers,
    ) -> Option<()> {
        while !until.is_reached(&draft.eye) {
            if !survives(&draft.eye, numbers) {
                return None;
            }
            let ray = match &mut draft.eye[..] {
                [] => {
                    draft.eye.push(self.eye_node(numbers)?);
                    continue;
                }
                [eye] => self.eye_ray(eye, self.any_position(numbers))?,
                [.., from, node] => {
                    let drawn = numbers.scatter();
                    self.scattered_ray(node, from, drawn, Quantity::Radiance)?
                }
            };
            draft.eye.push(self.meet(&ray, wavelengths)?);
        }
        Some(())
    }

    /// Walks on from the light's side, the first vertex drawn as the start of a walk.
    pub fn walk_from_light(
        &self,
        draft: &mut Draft,
        until: Until,
        wavelengths: &Wavelengths,
        numbers: &mut Numbers,
    ) -> Option<()> {
        while !until.is_reached(&draft.light) {
            if !survives(&draft.light, numbers) {
                return None;
            }
            if draft.light.is_empty() {
                draft.light.push(self.start_of_light(numbers)?);
                continue;
            }
            let ray = self.next_light_ray(draft, numbers)?;
            draft.light.push(self.meet(&ray, wavelengths)?);
        }
        Some(())
    }

    /// Walks on from the light's side until it meets the eye: at once, or where mirrors do not
    /// count, over these.
    fn walk_to_eye(
        &self,
        draft: &mut Draft,
        until: Until,
        wavelengths: &Wavelengths,
        numbers: &mut Numbers,
    ) -> Option<()> {
        loop {
            if !survives(&draft.light, numbers) {
                return None;
            }
            let ray = self.next_light_ray(draft, numbers)?;
            let hit = self.scene.geometry.intersect(&ray);
            if let Some((point, distance)) = self.eye.meet(&ray)
                && hit.is_none_or(|hit| hit.t > distance)
            {
                draft.light.push(Node::eye(point, true));
                return Some(());
            }
            let node = self.meet(&ray, wavelengths)?;
            if matches!(until, Until::Vertices(_)) || node.counts() {
                return None;
            }
            draft.light.push(node);
        }
    }

    fn next_light_ray(&self, draft: &mut Draft, numbers: &mut Numbers) -> Option<Ray> {
        match &mut draft.light[..] {
            [] => None,
            [light] => self.light_ray(light, numbers.pair()),
            [.., from, node] => {
                let drawn = numbers.scatter();
                self.scattered_ray(node, from, drawn, Quantity::Importance)
            }
        }
    }

    /// Completes a path with walks as long as `s` from the light and `t` from the eye, from
    /// whatever the draft holds already.
    pub fn complete(
        &self,
        draft: &mut Draft,
        (s, t): (Until, Until),
        wavelengths: &Wavelengths,
        numbers: &mut Numbers,
    ) -> Option<()> {
        let asks = s.vertices() == 1 && draft.light.is_empty();
        if t.vertices() == 0 {
            self.walk_from_light(draft, s.before(), wavelengths, numbers)?;
            return self.walk_to_eye(draft, s, wavelengths, numbers);
        }
        if !asks {
            self.walk_from_light(draft, s, wavelengths, numbers)?;
        }
        self.walk_from_eye(draft, t, wavelengths, numbers)?;
        let end = draft.eye.last_mut()?;
        if s.vertices() == 0 {
            *end = end.as_light()?;
            return Some(());
        }
        if end.is_mirror() {
            return None;
        }
        if asks {
            draft.light.push(self.asked_light(&end.point, wavelengths, numbers)?);
        }
        let start = draft.light.last()?;
        (!start.is_mirror() && self.sees(start, draft.eye.last()?)).then_some(())
    }
}
