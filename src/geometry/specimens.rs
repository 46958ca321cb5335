//! A named example of every kind of shape, for tests to loop over.

use super::{Mesh, Shape};
use glam::DVec3;

/// One example of every kind of shape, about a metre in size and off every symmetry, with a
/// name for failure messages.
pub fn specimens() -> Vec<(&'static str, Shape)> {
    let p = DVec3::new;
    let capped =
        |capped| Shape::Cylinder { from: p(-0.3, 0.1, -0.4), to: p(0.5, 0.4, 0.3), radius: 0.35, capped };
    vec![
        ("sphere", Shape::Sphere { center: p(0.1, -0.2, 0.3), radius: 0.7 }),
        ("open cylinder", capped(false)),
        ("capped cylinder", capped(true)),
        ("disk", Shape::Disk { center: p(0.2, 0.1, -0.3), normal: p(1.0, 2.0, -0.5), radius: 0.6 }),
        ("level disk", Shape::Disk { center: p(0.2, 0.1, -0.3), normal: p(0.0, 0.0, 1.0), radius: 0.6 }),
        (
            "parallelogram",
            Shape::Quad {
                vertices: [p(-0.5, -0.4, 0.1), p(0.4, -0.5, 0.3), p(0.7, 0.4, 0.5), p(-0.2, 0.5, 0.3)],
            },
        ),
        (
            "level square",
            Shape::Quad {
                vertices: [p(0.0, 0.0, 0.6), p(1.0, 0.0, 0.6), p(1.0, 1.0, 0.6), p(0.0, 1.0, 0.6)],
            },
        ),
        (
            "irregular quad",
            Shape::Quad {
                vertices: [p(0.0, 0.0, 0.0), p(0.9, 0.1, 0.0), p(0.6, 0.7, 0.0), p(0.1, 0.5, 0.0)],
            },
        ),
        ("box", Shape::Box { min: p(-0.4, -0.3, 0.1), max: p(0.5, 0.7, 0.9) }),
        ("icosphere", Shape::Mesh(icosphere(2))),
    ]
}

/// A closed mesh of 20 * 4^`level` triangles on the unit sphere around the origin, its
/// normals outward.
pub fn icosphere(level: u32) -> Mesh {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut positions = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        positions.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]].map(|v| DVec3::from(v).normalize()));
    }
    let mut triangles = hull_of_icosahedron(&positions);
    for _ in 0..level {
        triangles = subdivide(&mut positions, &triangles);
    }
    let normals = positions.clone();
    Mesh { positions, normals, triangles }
}

/// Every three mutually adjacent vertices, counter-clockwise from outside.
fn hull_of_icosahedron(positions: &[DVec3]) -> Vec<[u32; 3]> {
    let near = |i: usize, j: usize| positions[i].dot(positions[j]) > 0.4;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outward = positions[i].dot(positions[j].cross(positions[k])) > 0.0;
                    let [j, k] = if outward { [j, k] } else { [k, j] };
                    triangles.push([i as u32, j as u32, k as u32]);
                }
            }
        }
    }
    triangles
}

fn subdivide(positions: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((positions[a as usize] + positions[b as usize]).normalize());
            positions.len() as u32 - 1
        })
    };
    let mut finer = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    finer
}
