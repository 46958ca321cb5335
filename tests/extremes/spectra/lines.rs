//! Spectral lines, which have no width: drawn by themselves, beside a continuum or alone.

use crate::common::{illuminance, instrument_plan, irradiance, luminance, metered, read_seeded};
use crate::record::Record;
use etalon::camera::Sensor;
use etalon::geometry::SurfacePoint;
use etalon::integrator::Integrator;
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{MeterKind, Plan, Scene};
use etalon::spectrum::colour::xyz_at;
use etalon::spectrum::{LANES, Spectrum, Wavelengths};
use etalon::statistics::{BATCHES, BatchMean};
use serde_json::{Value, json};

fn lines(list: &[(f64, f64)], continuum: &Value) -> Value {
    let lines: Vec<Value> =
        list.iter().map(|(nm, power)| json!({ "wavelength_nm": nm, "power": power })).collect();
    json!({ "lines": { "lines": lines, "continuum": continuum } })
}

/// A point lamp 1 m above a meter.
fn over_a_meter(spectrum: &Value) -> Scene {
    let emission = json!({ "spectrum": spectrum, "level": { "flux_lm": 100 } });
    let lights = json!([{ "point": { "position": [0, 0, 0], "emission": emission } }]);
    metered(json!({}), json!([]), lights, illuminance([0., 0., -1.], [0., 0., 1.]))
}

// Case 11.
pub fn a_line_is_met_exactly(record: &mut Record) {
    let sodium = lines(&[(589.0, 1.0)], &json!(0));
    let facts = over_a_meter(&sodium).emitters.remove(0);
    let [x, y] = facts.chromaticity.unwrap_or([f64::NAN; 2]);
    record.absolute("x of the line at 589 nm", x, 0.569_257, 1e-6);
    record.absolute("y of the line at 589 nm", y, 0.430_102, 1e-6);
    record.relative("lm/W of the line at 589 nm", facts.luminous_flux.0 / facts.radiant_flux.0, 525.33, 1e-5);

    let shell = json!([{ "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } }, "material": "black",
        "emission": { "spectrum": sodium, "level": { "luminance_cd_m2": 100 }, "two_sided": true } }]);
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } } });
    let scene = metered(materials, shell, json!([]), luminance([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]));
    let reading = read_seeded(&scene, Integrator::Path, record.samples(1 << 12), record.seed());
    record.relative("luminance in a furnace of that line, cd/m2", reading.photometric.mean, 100.0, 2e-5);
    let variance = (reading.photometric.standard_error / reading.photometric.mean).powi(2) * (1 << 12) as f64;
    record.at_most("relative variance of a path there", variance, 1e-12);

    let doublet = over_a_meter(&lines(&[(589.0, 2.0), (589.6, 1.0)], &json!(0)));
    let shares = split(&doublet, record, |wavelengths, lane| wavelengths.line(lane) == Some(0));
    record.note(format!("A path carries {LANES} wavelengths, drawn among the lines that shine."));
    // Luminous flux: two parts at 589.0 nm and one at 589.6 nm, times the eye's response.
    let [first, second] = [2.0 * xyz_at(589.0)[1], xyz_at(589.6)[1]];
    let truth = first / (first + second);
    record.mean("share of the line at 589.0 nm of two", shares.mean, shares.standard_error, truth, 1e-3);
}

// Case 12.
pub fn lines_and_continuum_keep_their_shares(record: &mut Record) {
    let mercury = [(404.656_5, 0.3), (435.833, 0.9), (546.074, 1.0), (578.0, 0.4)];
    let of_lines: f64 = mercury.iter().map(|(nm, power)| power * xyz_at(*nm)[1]).sum();
    let continuum = etalon::spectrum::grid_nm().map(|nm| xyz_at(nm)[1]).sum::<f64>();
    // 0.3 of the luminous flux in the lines, 0.7 in a continuum of equal energy.
    let level = of_lines / 0.3 * 0.7 / continuum;
    let both = over_a_meter(&lines(&mercury, &json!(level)));
    let on_lines = split(&both, record, |wavelengths, lane| wavelengths.line(lane).is_some());
    record.relative("share of the lines", on_lines.mean, 0.3, 2e-3);
    record.mean("the same with its error", on_lines.mean, on_lines.standard_error, 0.3, 2e-3);
    let spectra = [lines(&mercury, &json!(level)), json!(level)];
    let [mixed, alone] = spectra.clone().map(|spectrum| variance(&grey_room(&spectrum), record));
    record.at_most(
        "relative variance of a path in a room over that of the continuum alone",
        mixed / alone,
        2.0,
    );
    let [mixed, alone] = spectra.map(|spectrum| variance(&over_a_meter(&spectrum), record));
    record.note(format!(
        "Where nothing but the wavelengths scatters, a lamp above a meter, the relative variance of a path is \
         {mixed:.4} with the lines and {alone:.4} without: eight rotated wavelengths leave a smooth continuum next \
         to no noise, so that the ratio says little there. Independent wavelengths would leave the lines' lamp \
         {:.4}, which is the bound.",
        independent(&mercury, level)
    ));
    record.at_most("relative variance of the wavelengths alone", mixed, independent(&mercury, level));
}

/// Relative variance of luminance from [`LANES`] independent wavelengths, each drawn in
/// proportion to the power times X + Y + Z, of lines on a continuum of one level.
fn independent(lines: &[(f64, f64)], level: f64) -> f64 {
    let parts = etalon::spectrum::grid_nm().map(|nm| (nm, level)).chain(lines.iter().copied());
    let (mut luminous, mut all, mut squares) = (0.0, 0.0, 0.0);
    for (nm, power) in parts {
        let [x, y, z] = xyz_at(nm).map(|value| value * power);
        luminous += y;
        all += x + y + z;
        squares += y * y / (x + y + z);
    }
    (squares * all / (luminous * luminous) - 1.0) / LANES as f64
}

/// A lamp in a grey room, seen by a meter on the floor.
fn grey_room(spectrum: &Value) -> Scene {
    let materials = json!({ "grey": { "lambertian": { "reflectance": 0.5 } } });
    let objects = json!([
        { "shape": { "box": { "min": [0, 0, 0], "max": [4, 4, 3] } }, "material": "grey" },
        { "shape": { "sphere": { "center": [1, 2, 2], "radius": 0.2 } }, "material": "grey",
          "emission": { "spectrum": spectrum, "level": { "flux_lm": 100 } } }
    ]);
    metered(materials, objects, json!([]), illuminance([2.5, 2.0, 0.0], [0.0, 0.0, 1.0]))
}

/// Paths to a scene's illuminance meter, one by one.
struct Paths<'a> {
    scene: &'a Scene,
    plan: Plan,
    sensor: Sensor,
}

impl<'a> Paths<'a> {
    fn of(scene: &'a Scene) -> Self {
        let sensor = Sensor::cie();
        Self { scene, plan: instrument_plan(scene, &sensor), sensor }
    }

    /// Luminous irradiance of a path, from chosen lanes and from all.
    fn one(
        &self,
        numbers: &BlockSampler,
        index: u32,
        keep: impl Fn(&Wavelengths, usize) -> bool,
    ) -> [f64; 2] {
        let sampler = numbers.sample(index);
        let wavelengths = self.plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let all = irradiance(self.scene, &self.plan, meter_point(self.scene), &wavelengths, &sampler);
        let kept = Spectrum::from_fn(|lane| if keep(&wavelengths, lane) { all[lane] } else { 0.0 });
        [kept, all].map(|received| {
            let mut luminous = 0.0;
            let put = |channel, value| luminous += if channel == 1 { value } else { 0.0 };
            self.sensor.record(received, &wavelengths, put);
            luminous
        })
    }
}

/// Share of the light that arrives on chosen lanes.
fn split(scene: &Scene, record: &Record, keep: impl Fn(&Wavelengths, usize) -> bool) -> BatchMean {
    let size = record.samples(1 << 13) as u32;
    let paths = Paths::of(scene);
    let share = |batch: usize| {
        let numbers = BlockSampler::new(record.seed(), 11, batch as u32, size);
        let sums = (0..size).map(|index| paths.one(&numbers, index, &keep));
        let [kept, all] = sums.fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
        kept / all
    };
    BatchMean::of(&std::array::from_fn::<_, BATCHES, _>(share))
}

/// Relative variance of one path.
fn variance(scene: &Scene, record: &Record) -> f64 {
    let size = record.samples(1 << 15) as u32;
    let numbers = BlockSampler::new(record.seed(), 12, 0, size);
    let paths = Paths::of(scene);
    let values: Vec<f64> = (0..size).map(|index| paths.one(&numbers, index, |_, _| true)[1]).collect();
    let mean = values.iter().sum::<f64>() / f64::from(size);
    values.iter().map(|value| (value / mean - 1.0).powi(2)).sum::<f64>() / f64::from(size - 1)
}

fn meter_point(scene: &Scene) -> SurfacePoint {
    match scene.meters[0].kind {
        MeterKind::Illuminance(point) => point,
        MeterKind::Luminance { .. } => panic!("an illuminance meter"),
    }
}
