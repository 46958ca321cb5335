//! The order in which threads are done.

use crate::common::scenes;
use crate::record::Record;
use etalon::camera::Film;
use etalon::integrator::{Budget, Integrator, Silent};
use etalon::scene::{Plan, Scene};
use rayon::ThreadPoolBuilder;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

/// Numbers of threads; rows are what they share, of which there must be enough for all.
const THREADS: [usize; 4] = [1, 2, 7, 64];
const RESOLUTION: [u32; 2] = [12, 64];

/// All that a film says of every pixel, as bits.
fn payload(film: &Film) -> Vec<u64> {
    let places = (0..film.pixels()).flat_map(|pixel| (0..film.channels()).map(move |c| (pixel, c)));
    places.flat_map(|(p, c)| [film.mean(p, c), film.standard_error(p, c)].map(f64::to_bits)).collect()
}

fn digest(payload: &[u64]) -> String {
    let mut hasher = DefaultHasher::new();
    payload.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

fn render(scene: &Scene, integrator: Integrator, budget: &Budget, threads: usize) -> Vec<u64> {
    let view = scene.view().expect("the scene has a camera");
    let mut view = view.clone();
    view.camera = view.camera.with_resolution(RESOLUTION);
    let plan = Plan::of(scene, &view.sensor, integrator.strategies());
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    let rendering = pool.install(|| integrator.render(scene, &view, &plan, budget, &Silent));
    payload(&rendering.film)
}

// Case 74.
pub fn any_number_of_threads_gives_the_same_bits(record: &mut Record) {
    let scene = crate::common::scene(&scenes::glass());
    let told = Budget { samples_per_pixel: 64, time: None, error: None, seed: record.seed() };
    let open = Budget { samples_per_pixel: 512, error: Some(0.2), ..told };
    let runs = Integrator::ALL.map(|integrator| (integrator.name().to_owned(), integrator, told));
    let until_an_error = ("path until an error".to_owned(), Integrator::Path, open);
    for (name, integrator, budget) in runs.into_iter().chain([until_an_error]) {
        let one = render(&scene, integrator, &budget, THREADS[0]);
        record.holds(format!("{name}: there is light"), one.iter().any(|bits| f64::from_bits(*bits) > 0.0));
        for threads in &THREADS[1..] {
            let many = render(&scene, integrator, &budget, *threads);
            record.exactly(format!("{name}: digest from {threads} threads"), digest(&many), digest(&one));
        }
    }
    record.note("The digest is one of 64 bits over every mean and standard error of the film.");
}
