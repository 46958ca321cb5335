//! The chain from radiance to digital values and pictures: closed forms, and what each stage
//! does by itself.

mod common;

use common::{SIGMAS, scene};
use etalon::camera::{CameraRecord, Darkroom, Planes, planes};
use etalon::integrator::{Budget, Integrator, Silent, render};
use etalon::scene::{Plan, Scene};
use serde_json::{Value, json};

/// A camera inside a black ball that shines with the same luminance everywhere.
fn ball(luminance_cd_m2: f64, spectrum: &Value, camera: &Value) -> Value {
    let mut whole = json!({
        "position": [0, 0, 0], "direction": [0, 0, 1], "up": [0, 1, 0],
        "focal_length_mm": 20, "sensor_mm": [36, 24], "resolution": [12, 8],
        "f_stop": 8, "shutter_s": 0.01, "iso": 100,
    });
    let keys = camera.as_object().expect("an object").clone();
    whole.as_object_mut().expect("an object").extend(keys);
    json!({
        "name": "ball", "length_unit": "m",
        "materials": { "black": { "lambertian": { "reflectance": 0 } } },
        "objects": [{
            "name": "ball", "material": "black",
            "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } },
            "emission": {
                "spectrum": spectrum, "level": { "luminance_cd_m2": luminance_cd_m2 }, "two_sided": true
            }
        }],
        "camera": whole,
    })
}

fn d65() -> Value {
    json!("d65")
}

/// A view's record and planes, rendered with a few samples.
fn rendered(scene: &Scene, samples_per_pixel: u64) -> (CameraRecord, Planes) {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, Integrator::Path.strategies());
    let budget = Budget { samples_per_pixel, time: None, error: None, seed: 1 };
    let film = render(scene, view, &plan, &budget, &Silent).film;
    (view.record(), planes(&film, &view.sensor, &view.flat_field()))
}

/// The record of a scene and planes that hold what an even field of a luminance of the white
/// would give, without rendering.
fn even(scene: &Scene, luminance_cd_m2: f64) -> (CameraRecord, Planes) {
    let view = scene.view().expect("a camera");
    let record = view.record();
    let whites = record.white.channels.iter().zip(&record.channels);
    let plane = |white: f64| vec![(white * luminance_cd_m2) as f32; record.optics.pixels()];
    let mut planes: Planes = whites.map(|(white, channel)| (channel.name.clone(), plane(*white))).collect();
    let xyz = record.white_xyz.unwrap_or([1.0; 3]);
    for (name, value) in ["X", "Y", "Z"].into_iter().zip(xyz) {
        planes.entry(name.to_owned()).or_insert_with(|| plane(value / xyz[1]));
    }
    (record, planes)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn levels(darkroom: &Darkroom<'_>, channel: usize) -> Vec<f64> {
    darkroom.counts(channel).expect("electronics").iter().map(|count| count.level).collect()
}

/// The saturation exposure of ISO 100, 0.78 lx s of 6500 K within 400-700 nm, frees 80 085
/// electrons in a pixel of 4.3 um with a quantum efficiency of 0.5: from a scene through
/// transport, lens, filter and detector.
#[test]
fn the_saturation_exposure_frees_its_electrons() {
    // H = q L t / N^2 = 0.78 lx s.
    let luminance = 0.78 * 64.0 / (0.65 * 0.01);
    // The nanometres from 400 to 700, ends included, on a grid that is joined linearly.
    let band = json!({ "table": { "wavelengths_nm": [399, 400, 700, 701], "values": [0, 1, 1, 0] } });
    let camera = json!({
        "sensor": { "filter_set": { "filters": { "Y": band }, "detector": { "quantum_efficiency": 1 } } },
        "electronics": { "quantum_efficiency": 0.5, "pixel_pitch_um": [4.3, 4.3] },
    });
    let daylight = json!({ "blackbody": { "temperature_k": 6500 } });
    let (record, planes) = rendered(&scene(&ball(luminance, &daylight, &camera)), 256);
    let darkroom = Darkroom::new(&record, &planes).expect("all channels");
    let (electrons, error) = mean(levels(&darkroom, 0).into_iter());
    assert!(error < 0.002 * electrons, "too noisy to judge: {electrons} +- {error}");
    // The figure has five digits; transport's numbers have 24 bits.
    let allowed = SIGMAS * error + 80_085.0 * 1e-4;
    assert!((electrons - 80_085.0).abs() < allowed, "{electrons} +- {error}");
}

/// A lens that passes the same share at all wavelengths is an exposure constant of
/// (pi/4) times that share, and neither counts it twice.
#[test]
fn a_grey_lens_is_the_constant_that_it_makes() {
    let stated = json!({ "lens_transmission": 0.9, "electronics": { "quantum_efficiency": 0.5 } });
    let constant = json!({
        "exposure_constant_q": std::f64::consts::FRAC_PI_4 * 0.9, "electronics": { "quantum_efficiency": 0.5 },
    });
    let [stated, constant] = [stated, constant].map(|c| even(&scene(&ball(300.0, &d65(), &c)), 300.0));
    for (name, a, b) in [
        ("q", stated.0.exposure_constant_q, constant.0.exposure_constant_q),
        ("white", stated.0.white_luminance_cd_m2, constant.0.white_luminance_cd_m2),
    ] {
        assert!((a / b - 1.0).abs() < 1e-6, "{name}: {a} against {b}");
    }
    assert_eq!(stated.0.channels[1].name, "sensor.Y");
    let rooms =
        [&stated, &constant].map(|(record, planes)| Darkroom::new(record, planes).expect("all channels"));
    let [a, b] = rooms.each_ref().map(|room| levels(room, 1)[0]);
    assert!((a / b - 1.0).abs() < 1e-6, "{a} electrons against {b}");
    let [a, b] = rooms.each_ref().map(|room| room.linear(0));
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() < 1e-6, "{a} against {b}");
    }
}

/// What a coloured lens passes of the ball's light is what its luminous transmission says, and
/// the ball is developed as bright as without a lens: the sensor is set for it.
#[test]
fn a_coloured_lens_is_weighted_by_wavelength() {
    let lens =
        json!({ "table": { "wavelengths_nm": [360, 500, 600, 830], "values": [0.1, 0.2, 0.9, 0.95] } });
    let camera =
        json!({ "lens_transmission": lens, "white_balance": "d65", "development": { "tone": "linear" } });
    let scene = scene(&ball(300.0, &d65(), &camera));
    let (record, planes) = rendered(&scene, 512);
    let share = record.white.luminous_transmission;
    assert!((0.2..0.9).contains(&share), "{share}");
    let ratios = planes["sensor.Y"].iter().zip(&planes["Y"]).map(|(a, b)| f64::from(*a) / f64::from(*b));
    let (ratio, error) = mean(ratios);
    assert!(error < 0.005 * ratio, "too noisy to judge: {ratio} +- {error}");
    assert!((ratio - share).abs() < SIGMAS * error, "{ratio} +- {error}, truth {share}");
    // H = q L t / N^2 reaches 0.78 lx s at white, with the transmission in q.
    let truth = 300.0 * record.exposure_constant_q * 0.01 / 64.0 / 0.78;
    let darkroom = Darkroom::new(&record, &planes).expect("all channels");
    for channel in 0..3 {
        let (level, error) = mean((0..96).map(|pixel| darkroom.linear(pixel)[channel]));
        assert!(error < 0.01 * level, "too noisy to judge: {level} +- {error}");
        assert!((level - truth).abs() < SIGMAS * error + 1e-4 * truth, "{level} +- {error}, truth {truth}");
    }
}

/// Every pixel of an even field is darker by cos^4 of the angle that its own ray makes with
/// the axis, wherever the axis meets the picture.
#[test]
fn natural_vignetting_follows_the_rays() {
    let camera = json!({ "vignetting": "cos4", "principal_point_px": [2.5, -1.5] });
    let scene = scene(&ball(300.0, &d65(), &camera));
    let (record, mut planes) = even(&scene, 300.0);
    planes.values_mut().flatten().for_each(|value| *value = 300.0);
    let darkroom = Darkroom::new(&record, &planes).expect("all channels");
    let lens = &scene.view().expect("a camera").camera;
    // On the axis: q is that of the axis.
    let axis = 300.0 / record.white_luminance_cd_m2;
    for pixel in 0..96 {
        let place = [f64::from(pixel % 12) + 0.5, f64::from(pixel / 12) + 0.5];
        let ray = lens.ray(place, [0.0; 2]).direction.as_dvec3();
        let truth = ray.dot(lens.placement().forward).powi(4);
        let [_, green, _] = darkroom.linear(pixel as usize);
        let reference = even_green(&record, axis);
        assert!((green / reference / truth - 1.0).abs() < 1e-6, "{place:?}: {green} against {truth}");
    }
}

/// Linear green of X = Y = Z at a level, by the matrix of IEC 61966-2-1.
fn even_green(record: &CameraRecord, level: f64) -> f64 {
    assert!(record.white_xyz.is_none());
    level * (-0.969_243_636_280_879 + 1.875_967_501_507_72 + 0.041_555_057_407_175)
}

/// Darker corners do not change what the axis shows: the lens constant is that of the axis,
/// 0.65 without its fall-off to ten degrees.
#[test]
fn the_lens_constant_is_that_of_the_axis_where_a_fall_off_is_stated() {
    let q = |camera: Value| scene(&ball(1.0, &d65(), &camera)).view().expect("a camera").exposure.q;
    let cos4 = 10.0_f64.to_radians().cos().powi(4);
    assert_eq!(q(json!({})), 0.65);
    assert!((q(json!({ "vignetting": "cos4" })) * cos4 - 0.65).abs() < 0.005);
    assert_eq!(q(json!({ "vignetting": "cos4", "exposure_constant_q": 0.7 })), 0.7);
    // A lens of 20 mm that focuses at 60 mm has its image at 30 mm.
    let near = q(json!({ "lens_transmission": 1, "focus_distance": 0.06 }));
    assert!((near - std::f64::consts::FRAC_PI_4 * 4.0 / 9.0).abs() < 1e-6, "{near}");
}

/// Shot noise of an even field: variance equals mean, within five standard errors of the
/// variance, sqrt(2 / n): false alarm once in 1.7 million.
#[test]
fn shot_noise_has_the_variance_of_its_mean() {
    let camera = json!({
        "resolution": [192, 128], "electronics": { "quantum_efficiency": 0.5, "pixel_pitch_um": [1, 1] },
        "noise": { "seed": 11 },
    });
    let scene = scene(&ball(300.0, &d65(), &camera));
    let (record, planes) = even(&scene, 300.0);
    let quiet = CameraRecord { noise: None, ..record.clone() };
    let truth = levels(&Darkroom::new(&quiet, &planes).expect("all channels"), 1)[0];
    assert!((20.0..2000.0).contains(&truth), "{truth}");
    let electrons = levels(&Darkroom::new(&record, &planes).expect("all channels"), 1);
    let n = electrons.len() as f64;
    let (average, error) = mean(electrons.iter().copied());
    assert!((average - truth).abs() < SIGMAS * (truth / n).sqrt(), "{average} for {truth}");
    let variance = error * error * n;
    let spread = ((2.0 + 1.0 / truth) / n).sqrt();
    assert!((variance / truth - 1.0).abs() < SIGMAS * spread, "{variance} for {truth}");
}

/// Channels of a pixel, and pixels of a channel, have noise of their own: correlations of
/// |z| < 5, false alarm once in 1.7 million each.
#[test]
fn noise_is_independent_between_channels_and_neighbours() {
    let camera = json!({
        "resolution": [192, 128], "electronics": { "quantum_efficiency": 0.5, "pixel_pitch_um": [1, 1] },
        "noise": {},
    });
    let (record, planes) = even(&scene(&ball(300.0, &d65(), &camera)), 300.0);
    let darkroom = Darkroom::new(&record, &planes).expect("all channels");
    let [x, y] = [0, 1].map(|channel| levels(&darkroom, channel));
    let z = |a: &[f64], b: &[f64]| {
        let n = a.len() as f64;
        let [(ma, ea), (mb, eb)] = [a, b].map(|v| mean(v.iter().copied()));
        let covariance = a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum::<f64>() / n;
        covariance / (ea * eb * n) * n.sqrt()
    };
    let n = x.len();
    for (what, z) in
        [("channels", z(&x, &y)), ("columns", z(&x[1..], &x[..n - 1])), ("rows", z(&x[192..], &x[..n - 192]))]
    {
        assert!(z.abs() < SIGMAS, "{what}: z = {z}");
    }
}

/// A full well clips, the clipped pixels are counted, and rounding to digital values moves the
/// picture by half a step at most.
#[test]
fn full_wells_clip_and_digits_round() {
    let electronics = json!({
        "quantum_efficiency": 0.5, "pixel_pitch_um": [4, 4], "full_well_electrons": 20_000,
        "bit_depth": 10, "black_level_dn": 20,
    });
    let camera = json!({
        "electronics": electronics, "vignetting": "cos4", "development": { "tone": "linear" } });
    let scene = scene(&ball(1.0, &d65(), &camera));
    let (record, mut planes) = even(&scene, 1.0);
    let per_value = record.counter().expect("electronics").electrons_per_value;
    // The well is full on the axis and not in the corners, where cos^4 is 0.24.
    let value = (40_000.0 / per_value) as f32;
    planes.values_mut().flatten().for_each(|v| *v = value);
    let darkroom = Darkroom::new(&record, &planes).expect("all channels");
    let counts = darkroom.counts(1).expect("electronics");
    let falloff = record.vignetting.over_picture(&record.optics, &[]).expect("cos4");
    for (pixel, count) in counts.iter().enumerate() {
        let electrons = f64::from(value) * per_value * falloff[pixel];
        assert_eq!(count.saturated, electrons >= 20_000.0, "{electrons} electrons");
        let truth = 20.0 + electrons.min(20_000.0) * (1023.0 - 20.0) / 20_000.0;
        assert!((count.level - truth).abs() <= 0.5 + 1e-9, "{} for {truth}", count.level);
        assert_eq!(count.level.fract(), 0.0);
    }
    let full = counts.iter().filter(|count| count.saturated).count();
    assert!((1..95).contains(&full), "{full}");
    assert_eq!(darkroom.saturated_pixels(), Some(full as u64));
}

/// Where light of the white fills the wells, the picture is white as well, at the level of the
/// first channel that is full: not the colour of the channels that have room left.
#[test]
fn what_is_too_bright_is_white() {
    let camera = json!({
        "sensor": "nikon-5100", "white_balance": "cie-a",
        "electronics": {
            "quantum_efficiency": 0.5, "pixel_pitch_um": [4, 4], "full_well_electrons": 20_000, "bit_depth": 12 },
        "development": { "fit_matrix": true, "tone": "linear" },
    });
    let scene = scene(&ball(1.0, &json!("cie-a"), &camera));
    let (record, _) = even(&scene, 1.0);
    let per_value = record.counter().expect("electronics").electrons_per_value;
    let most = record.white.channels.iter().fold(0.0, |a: f64, b| a.max(*b));
    let full_luminance = 20_000.0 / (per_value * most);
    let level = |luminance: f64| {
        let (record, planes) = even(&scene, luminance);
        Darkroom::new(&record, &planes).expect("all channels").linear(0)
    };
    let full = full_luminance / record.white_luminance_cd_m2;
    // A step of 12 bits is one part in 4095 of the fullest channel, more of the others.
    for (luminance, truth) in [(0.5 * full_luminance, 0.5 * full), (2.0 * full_luminance, full)] {
        for channel in level(luminance) {
            assert!((channel / truth - 1.0).abs() < 0.005, "{channel} against {truth}");
        }
    }
}

/// Filters before a detector and a matrix: what is lit by the white light is neutral, at the
/// level that its luminance has.
#[test]
fn a_matrix_shows_the_white_neutral_at_its_luminance() {
    let camera = json!({
        "sensor": { "filter_set": {
            "filters": { "B450": "cornell-filter-450", "B550": "cornell-filter-550", "B650": "cornell-filter-650" },
            "detector": { "relative_responsivity": 1 } } },
        "lens_transmission": "cornell-lens-nikon55",
        "white_balance": "d65",
        "development": { "tone": "linear", "matrix": {
            "to": "srgb", "rows": [[0, 0, 1], [0, 1, 0], [1, 0, 0]] } },
    });
    let scene = scene(&ball(300.0, &d65(), &camera));
    let (record, planes) = rendered(&scene, 256);
    let names: Vec<&str> = record.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, ["sensor.B450", "sensor.B550", "sensor.B650"]);
    let darkroom = Darkroom::new(&record, &planes).expect("all channels");
    let truth = 300.0 / record.white_luminance_cd_m2;
    for channel in 0..3 {
        let (level, error) = mean((0..96).map(|pixel| darkroom.linear(pixel)[channel]));
        assert!(error < 0.01 * level, "too noisy to judge: {level} +- {error}");
        assert!((level - truth).abs() < SIGMAS * error + 1e-4 * truth, "{level} +- {error}, truth {truth}");
    }
}

/// At the extremes the record says what is not modelled, and in between nothing.
#[test]
fn extremes_are_warned_of() {
    let warnings =
        |camera: Value| scene(&ball(1.0, &d65(), &camera)).view().expect("a camera").record().warnings;
    assert_eq!(warnings(json!({})), Vec::<String>::new());
    for (camera, word) in [
        (json!({ "f_stop": 0.5 }), "paraxial"),
        // 2.44 * 0.55 um * 1000 = 1.342 mm.
        (json!({ "f_stop": 1000, "resolution": [360, 240] }), "1.342"),
        (json!({ "shutter_s": 3600 }), "reciprocity"),
    ] {
        let said = warnings(camera);
        assert!(said.len() == 1 && said[0].contains(word), "{said:?}");
    }
}

/// A well that is full two stops below white is warned of with that figure, one that is full
/// above white is not, and the picture of white is as dark as the warning says.
#[test]
fn wells_that_are_full_below_white_are_warned_of() {
    let of = |electronics: Value| {
        let camera = json!({ "electronics": electronics, "white_balance": "d65", "development": { "tone": "linear" } });
        scene(&ball(1.0, &d65(), &camera))
    };
    let well = |electrons: f64| json!({ "quantum_efficiency": 0.5, "pixel_pitch_um": [4, 4], "full_well_electrons": electrons });
    let record = of(well(1.0)).view().expect("a camera").record();
    let brightest = record.white.channels.iter().fold(0.0, |a: f64, b| a.max(*b));
    let per_value = record.counter().expect("electronics").electrons_per_value;
    let at_white = record.white_luminance_cd_m2 * brightest * per_value;
    let (record, planes) = even(&of(well(at_white / 4.0)), record.white_luminance_cd_m2);
    assert!(record.warnings.len() == 1 && record.warnings[0].contains("2.0 stops"), "{:?}", record.warnings);
    let level = Darkroom::new(&record, &planes).expect("all channels").linear(0)[1];
    assert!((level - 0.25).abs() < 1e-4, "{level}");
    let (record, _) = even(&of(well(at_white * 1.1)), 1.0);
    assert_eq!(record.warnings, Vec::<String>::new());
    let (record, _) = even(&of(json!({ "quantum_efficiency": 0.5 })), 1.0);
    // 36 mm over 12 pixels.
    let said = &record.warnings;
    assert!(said.len() == 1 && said[0].contains("3000.000 x 3000.000 um follow from sensor_mm"), "{said:?}");
}
