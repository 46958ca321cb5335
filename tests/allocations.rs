//! The inner loop takes no memory: more samples in a block do not mean more allocations.

mod common;

use common::rooms::rooms;
use etalon::integrator::{Budget, Integrator, Silent};
use etalon::scene::{Plan, Scene};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[expect(unsafe_code, reason = "only an allocator sees every allocation")]
// SAFETY: every call is handed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// Pixels of a wide picture: rows have buffers of their own.
const RESOLUTION: [u32; 2] = [96, 4];
/// Allocations for each further sample that are allowed: buffers of rows grow by doubling.
const PER_SAMPLE: f64 = 0.02;

/// Allocations of a render of four blocks.
fn allocations(scene: &Scene, integrator: Integrator, samples_per_pixel: u64) -> u64 {
    let mut view = scene.view().expect("a camera").clone();
    view.camera = view.camera.with_resolution(RESOLUTION);
    let plan = Plan::of(scene, &view.sensor, integrator.strategies());
    let budget = Budget { samples_per_pixel, time: None, error: None, seed: 1 };
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    integrator.render(scene, &view, &plan, &budget, &Silent);
    ALLOCATIONS.load(Ordering::Relaxed) - before
}

#[test]
fn samples_take_no_memory() {
    for (name, scene) in rooms() {
        for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
            // The first render also sets up threads.
            allocations(&scene, integrator, 4);
            let [few, many] = [32, 64].map(|samples| allocations(&scene, integrator, samples));
            let further = f64::from(32 * RESOLUTION[0] * RESOLUTION[1]);
            let per_sample = (many as f64 - few as f64) / further;
            assert!(per_sample < PER_SAMPLE, "{name}, {}: {few}, then {many}", integrator.name());
        }
    }
}
