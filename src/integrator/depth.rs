//! How long paths may get: as long as roulette lets them, unless there is no picture at all.
//!
//! Between surfaces that lose nothing and let nothing out, light that is fed in grows without
//! end: the radiance that a picture would show is infinite, and every estimate of it a number
//! that means nothing. Where next to nothing is lost it has a value, tens of thousands of times what
//! is fed in, that no walk reaches in time. That cannot be read off a list of materials (a lamp, a window or a crack
//! ends it), so walks look for it: where of many long ones hardly any has ended or lost anything, and
//! all go on finding light, paths are cut off after [`DIVERGENT_BOUNCES`], and it is said.

use super::tracer::{Draw, Tracer};
use crate::path::{BothFates, Eye, Strategies, Subpaths, TRAPPED_BOUNCES};
use crate::sampler::{BlockSampler, Stream};
use crate::scene::{Plan, Scene};
use serde::Serialize;
use std::borrow::Cow;

/// Walks that must be trapped: none ending in this many times [`TRAPPED_BOUNCES`] puts the
/// probability that a bounce ends one below 1.2e-5, with 95 %.
const WALKS: u32 = 256;
/// Of these, so many may end all the same: rounding makes a direction lie in its surface once in
/// some million bounces.
const MOST_ENDED: u32 = 2;
/// Limits on the mean, with 95 % confidence, of a Poisson count that came out as 0, 1 or 2.
const POISSON_LIMITS: [f64; MOST_ENDED as usize + 1] = [3.00, 4.74, 6.30];
/// Of these, as many must be where light is exchanged with the eye.
const FEWEST_TRAPPED: u32 = 32;
/// Bounces after which paths are cut off where radiance has no finite value.
pub const DIVERGENT_BOUNCES: u32 = 250;
/// Walks that tell what is cut off where a picture is made of chains.
const WALKS_BESIDE_CHAINS: u32 = 1 << 12;
/// Names the random numbers of these walks.
const SEED: u64 = 0x6f64_6570_7468;

/// Evidence that radiance has no finite value where the eye looks, or one that no walk reaches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// Walks, each of which was followed for so many bounces, and lost nothing but what rounding
    /// takes.
    pub walks: u32,
    /// See `walks`.
    pub bounces: u32,
    /// Those that ended before.
    pub ended: u32,
    /// With 95 % confidence, a bounce ends a walk with less than this probability.
    pub loss_per_bounce_below: f64,
}

/// What the length of paths has done to a picture or a reading.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Truncation {
    /// Bounces after which paths were cut off; `None`: there was no limit.
    pub max_bounces: Option<u32>,
    /// Why the limit was set where nobody asked for it.
    pub divergence: Option<Divergence>,
    /// Walks that what follows is known from.
    pub walks: u64,
    /// Share of the energy that walks set out with and still carried when they were cut off.
    pub energy_truncated: f64,
    /// That share is at least this, with 95 % confidence.
    pub energy_truncated_at_least: f64,
    /// Share of the energy that was trapped: that had lost nothing in 1000 bounces. Unless it is
    /// cut off, it is followed on and nothing is lost.
    pub energy_trapped: f64,
    /// Walks that carried it.
    pub walks_trapped: u64,
}

/// A plan whose paths end.
pub struct Bounded<'p> {
    /// The plan, with a limit where one is needed.
    pub plan: Cow<'p, Plan>,
    /// Why.
    pub divergence: Option<Divergence>,
}

impl<'p> Bounded<'p> {
    /// The plan itself, or with a limit where radiance has no finite value.
    pub fn of(scene: &Scene, plan: &'p Plan, eye: Eye<'_>) -> Self {
        let divergence = divergence(scene, plan, eye);
        let mut plan = Cow::Borrowed(plan);
        if divergence.is_some() && plan.most_bounces.is_none() {
            plan.to_mut().most_bounces = Some(DIVERGENT_BOUNCES);
        }
        Self { plan, divergence }
    }

    /// What became of the walks of a picture or a reading.
    pub fn truncation(&self, fates: &BothFates) -> Truncation {
        let fates = fates.of_the_picture();
        Truncation {
            max_bounces: self.plan.most_bounces,
            divergence: self.divergence,
            walks: fates.walks,
            energy_truncated: fates.cut_share(),
            energy_truncated_at_least: fates.cut_share_at_least(),
            energy_trapped: fates.trapped_share(),
            walks_trapped: fates.trapped,
        }
    }

    /// What became of some walks from the eye, for a picture that is not made of walks.
    pub fn fates_beside_chains(&self, scene: &Scene, eye: Eye<'_>) -> BothFates {
        let plan = Plan { strategies: Strategies::PATH, ..self.plan.as_ref().clone() };
        let mut probe = Probe::new(scene, &plan, eye, WALKS_BESIDE_CHAINS);
        let mut fates = BothFates::default();
        for index in 0..WALKS_BESIDE_CHAINS {
            probe.walk(index);
            fates.merge(&probe.paths.fates);
        }
        fates
    }
}

impl Truncation {
    /// What a user must know, if anything: that paths were cut off, and what that has cost.
    pub fn message(&self) -> Option<String> {
        let Self { max_bounces: Some(most), divergence, walks, .. } = *self else { return None };
        let [share, least] =
            [self.energy_truncated, self.energy_truncated_at_least].map(|share| 100.0 * share);
        Some(match divergence {
            Some(Divergence { walks: followed, bounces, ended, loss_per_bounce_below }) => format!(
                "radiance has no finite value here, or one that is out of reach: of {followed} walks of {bounces} bounces {ended} ended and the others lost nothing \
                 (a bounce loses less than {loss_per_bounce_below:.1e}, 95 %), and light is fed in; paths are cut off after \
                 {most} bounces, energy truncated >= {:.1} %; give a surface a reflectance below 1, or an opening",
                (10.0 * least).floor() / 10.0
            ),
            None => format!(
                "paths are cut off after {most} bounces: energy truncated {share:.2} % (>= {least:.2} % at 95 %, from {walks} walks)"
            ),
        })
    }

    /// That light was trapped, where it was.
    pub fn trapped_message(&self) -> Option<String> {
        (self.walks_trapped > 0 && self.divergence.is_none()).then(|| {
            format!(
                "trapped light: {:.2} % of the energy of {} walks had lost nothing in {TRAPPED_BOUNCES} bounces",
                100.0 * self.energy_trapped,
                self.walks
            )
        })
    }
}

/// Walks of a plan, one by one.
struct Probe<'a> {
    tracer: Tracer<'a>,
    plan: &'a Plan,
    size: [f64; 2],
    numbers: BlockSampler,
    paths: Subpaths,
}

impl<'a> Probe<'a> {
    fn new(scene: &'a Scene, plan: &'a Plan, eye: Eye<'a>, walks: u32) -> Self {
        let size = match eye {
            Eye::Camera(camera) => camera.resolution().map(f64::from),
            Eye::Irradiance(_) | Eye::Radiance(_) => [1.0; 2],
        };
        Self {
            tracer: Tracer::new(scene, plan, eye),
            plan,
            size,
            numbers: BlockSampler::new(SEED, 0, 0, walks),
            paths: Subpaths::default(),
        }
    }

    /// Takes a walk.
    fn walk(&mut self, index: u32) -> Walked {
        let sampler = self.numbers.sample(index);
        let wavelengths = self.plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let [x, y] = sampler.pair(Stream::Pixel, 0).map(f64::from);
        let position = [x * self.size[0], y * self.size[1]];
        let draw = Draw { position, wavelengths: &wavelengths, sampler: &sampler };
        let mut walked = Walked::default();
        self.paths.fates = BothFates::default();
        self.tracer.trace(&draw, &mut self.paths, &mut |found| {
            let shines = !found.estimate.is_black();
            walked.finds_light |= shines;
            walked.finds_it_late |= shines && found.s + found.t > TRAPPED_BOUNCES as usize / 2;
        });
        let fates = self.paths.fates.of_the_picture();
        walked.is_trapped = fates.trapped > 0;
        walked.ended_by_rounding = fates.ended_by_rounding > 0;
        walked
    }
}

/// What a walk from one end has come to.
#[derive(Clone, Copy, Default)]
struct Walked {
    is_trapped: bool,
    ended_by_rounding: bool,
    finds_light: bool,
    /// After half of the bounces that count as trapped.
    finds_it_late: bool,
}

/// What all walks from one end have come to.
#[derive(Clone, Copy, Default)]
struct End {
    /// All that were somewhere that light is exchanged with were trapped.
    is_trapped: bool,
    /// And went on finding light.
    finds_light: bool,
    /// Those that ended all the same.
    ended: u32,
}

/// Follows walks from one end, up to the first that is not trapped.
fn follow(scene: &Scene, plan: &Plan, strategies: Strategies, eye: Eye<'_>) -> End {
    let strategies = Strategies { joins: false, light_to_eye: false, ..strategies };
    if !strategies.follows_eye() && !strategies.follows_light() {
        return End::default();
    }
    let plan = Plan { strategies, most_bounces: Some(TRAPPED_BOUNCES), ..plan.clone() };
    let mut probe = Probe::new(scene, &plan, eye, WALKS);
    let (mut trapped, mut late, mut ended) = (0, 0, 0);
    for index in 0..WALKS {
        let walked = probe.walk(index);
        trapped += u32::from(walked.is_trapped);
        late += u32::from(walked.is_trapped && walked.finds_it_late);
        // Light that goes astray at once, as from the outside of a lamp, says nothing.
        let is_evidence = (strategies.follows_eye() || walked.finds_light) && !walked.ended_by_rounding;
        ended += u32::from(is_evidence && !walked.is_trapped);
        if ended > MOST_ENDED || trapped == 0 && index >= FEWEST_TRAPPED {
            return End::default();
        }
    }
    End { is_trapped: trapped >= FEWEST_TRAPPED, finds_light: late > 0, ended }
}

/// Whether radiance has no finite value where an eye looks; found out by the first walks that end
/// where it has.
fn divergence(scene: &Scene, plan: &Plan, eye: Eye<'_>) -> Option<Divergence> {
    if plan.direct_only || scene.lights.is_empty() {
        return None;
    }
    let all = plan.strategies;
    let from_eye = Strategies { asks_eye: false, meets_eye: false, ..all };
    let from_lights = Strategies { meets_lights: false, asks_lights: false, ..all };
    let from_eye = follow(scene, plan, from_eye, eye);
    // Joined to walks that end, those from lights make paths that end.
    if all.joins && !from_eye.is_trapped {
        return None;
    }
    let from_lights =
        if from_eye.finds_light { End::default() } else { follow(scene, plan, from_lights, eye) };
    let joined = all.joins && from_eye.is_trapped && from_lights.is_trapped;
    let ended = from_eye.ended.max(from_lights.ended);
    let steps = f64::from(WALKS) * f64::from(TRAPPED_BOUNCES);
    (joined || from_eye.finds_light || from_lights.finds_light).then_some(Divergence {
        walks: WALKS,
        bounces: TRAPPED_BOUNCES,
        ended,
        loss_per_bounce_below: POISSON_LIMITS[ended as usize] / steps,
    })
}
