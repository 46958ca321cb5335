//! `etalon develop` as a user meets it: the same pictures as rendering, and files that say how
//! they were exposed.

use exr::prelude::{AttributeValue, ReadChannels, ReadLayers};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the program with words split at blanks, in a folder.
fn etalon(folder: &Path, words: &str) -> Output {
    etalon_with(folder, words, 0)
}

/// The same on a number of threads; 0 leaves it open.
fn etalon_with(folder: &Path, words: &str, threads: usize) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(folder).args(words.split(' ')).env("RAYON_NUM_THREADS", threads.to_string());
    command.output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the program writes UTF-8")
}

fn succeed(folder: &Path, words: &str) -> String {
    let output = etalon(folder, words);
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""), "{words}");
    text(&output.stdout)
}

/// The one line of a run that must fail by the user's fault.
fn fail(folder: &Path, words: &str) -> String {
    let output = etalon(folder, words);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{words}: {said}");
    assert!(said.starts_with("error: ") && !said.contains("panicked"), "{said}");
    said
}

fn fail_in_one_line(folder: &Path, words: &str) -> String {
    let said = fail(folder, words);
    let line = said.strip_suffix('\n').expect("the line ends").to_owned();
    assert!(!line.contains(char::is_control), "{said:?}");
    line
}

fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("develop-{test}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

/// A small scene with a camera of many stages, and what `changes` say otherwise.
fn write_scene(folder: &Path, name: &str, changes: &Value) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/sound.json");
    let mut scene: Value = serde_json::from_str(&std::fs::read_to_string(file).expect("read")).expect("JSON");
    let all = json!({
        "resolution": [48, 32], "focal_length_mm": 25, "shutter_s": 0.1, "iso": 400,
        "vignetting": "cos4", "white_balance": "d65",
        "electronics": {
            "quantum_efficiency": 0.5, "pixel_pitch_um": [4.3, 4.3], "full_well_electrons": 30000,
            "read_noise_electrons": 4, "dark_current_electrons_per_s": 50, "bit_depth": 12, "black_level_dn": 64
        },
    });
    scene["materials"]["red"] = json!({ "lambertian": { "reflectance": "cornell-red" } });
    let objects = scene["objects"].as_array_mut().expect("a list");
    let wall = [[4, -3, 2], [-4, -3, 2], [-4, 5, 2], [4, 5, 2]];
    objects.push(json!({ "name": "wall", "material": "white", "shape": { "quad": { "vertices": wall } } }));
    let ball = json!({ "sphere": { "center": [1, 0.5, 0], "radius": 0.5 } });
    objects.push(json!({ "name": "ball", "material": "red", "shape": ball }));
    let camera = scene["camera"].as_object_mut().expect("a camera");
    for change in [&all, changes] {
        for (key, value) in change.as_object().expect("an object") {
            if value.is_null() {
                camera.remove(key)
            } else {
                camera.insert(key.clone(), value.clone())
            };
        }
    }
    std::fs::write(folder.join(format!("{name}.json")), scene.to_string()).expect("written");
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Developing a render with settings gives, byte for byte, the file that rendering with them
/// gives: every setting by itself and several together, in every format.
#[test]
fn developing_later_is_rendering_with_other_settings() {
    let folder = folder("later");
    let srgb = json!({ "to": "srgb", "rows": [[1.2, -0.2, 0], [-0.1, 1.2, -0.1], [0, -0.3, 1.3]] });
    std::fs::write(folder.join("matrix.json"), srgb.to_string()).expect("written");
    let nikon = json!({ "sensor": "nikon-5100", "lens_transmission": "cornell-lens-nikon55" });
    for (case, (before, options, changes)) in [
        (json!({}), "--iso 200", json!({ "iso": 200 })),
        (json!({}), "--shutter 1/64", json!({ "shutter_s": 0.015625 })),
        (json!({}), "--f-stop 5.6", json!({ "f_stop": 5.6 })),
        (json!({}), "--anchor meter", json!({ "anchor": "meter" })),
        (json!({}), "--white-balance cie-a", json!({ "white_balance": "cie-a" })),
        (json!({}), "--white-balance none", json!({ "white_balance": null })),
        (json!({}), "--tone gamma=1.8", json!({ "development": { "tone": { "gamma": 1.8 } } })),
        (json!({}), "--noise --seed 5", json!({ "noise": { "seed": 5 } })),
        (json!({ "noise": { "seed": 5 } }), "--seed 6", json!({ "noise": { "seed": 6 } })),
        (json!({}), "--without vignetting", json!({ "vignetting": "none", "exposure_constant_q": STANDARD_ON_AXIS })),
        (json!({}), "--without electrons", json!({ "electronics": null })),
        (
            nikon.clone(),
            "--matrix fitted --white-balance d65",
            json!({ "development": { "fit_matrix": true } }),
        ),
        (
            json!({ "sensor": "nikon-5100", "development": { "fit_matrix": true } }),
            "--white-balance cie-a",
            json!({ "white_balance": "cie-a" }),
        ),
        (nikon.clone(), "--matrix matrix.json", json!({ "development": { "matrix": srgb } })),
        (
            nikon,
            "--matrix matrix.json --iso 800 --shutter 1/32 --f-stop 4 --anchor sos --white-balance d50 --noise --tone linear",
            json!({
                "iso": 800, "shutter_s": 0.03125, "f_stop": 4, "anchor": "sos", "white_balance": "d50",
                "noise": {}, "development": { "matrix": srgb, "tone": "linear" }
            }),
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let ending = ["png", "tiff", "jpg"][case % 3];
        let mut changed = before.clone();
        changed.as_object_mut().expect("an object").extend(changes.as_object().expect("an object").clone());
        write_scene(&folder, "before", &before);
        write_scene(&folder, "changed", &changed);
        succeed(&folder, &format!("render before.json -o before.exr --spp 4 --png before.{ending}"));
        succeed(&folder, &format!("render changed.json -o changed.exr --spp 4 --png changed.{ending}"));
        succeed(&folder, &format!("develop before.exr -o later.{ending} {options}"));
        let [before, changed, later] =
            ["before", "changed", "later"].map(|name| bytes(&folder, &format!("{name}.{ending}")));
        assert!(later == changed, "{options}: another file");
        assert!(later != before, "{options}: nothing has changed");
    }
}

/// What a scene without a fall-off must state to have the lens constant of one with it.
const STANDARD_ON_AXIS: f64 = etalon::camera::STANDARD_Q_ON_AXIS;

/// A flat field of the render's own size is applied as it is, and travels in the EXR.
#[test]
fn a_flat_field_is_kept_with_the_render() {
    let folder = folder("flat");
    let field = image::ImageBuffer::from_fn(48, 32, |x, _| image::Luma([40_000_u16 - 500 * x as u16]));
    field.save(folder.join("flat.png")).expect("saved");
    write_scene(
        &folder,
        "scene",
        &json!({
            "vignetting": { "flat_field": { "file": "flat.png" } }, "electronics": null,
            "development": { "tone": "linear" }, "white_balance": null,
        }),
    );
    succeed(&folder, "render scene.json -o scene.exr --spp 4 --png scene.tiff");
    std::fs::remove_file(folder.join("flat.png")).expect("removed");
    succeed(&folder, "develop scene.exr -o later.tiff");
    assert_eq!(bytes(&folder, "later.tiff"), bytes(&folder, "scene.tiff"));
    succeed(&folder, "develop scene.exr -o with.exr");
    succeed(&folder, "develop scene.exr -o without.exr --without vignetting");
    let [with, without] = ["with.exr", "without.exr"].map(|name| channel(&folder.join(name), "G"));
    let middle = |x: usize| 40_000.0 - 500.0 * x as f64;
    // The middle tenth: five columns around the middle, 21.6 to 26.4 counted from the left.
    let level = (22..=25).map(middle).sum::<f64>() / 4.0;
    let mut seen = 0;
    for (pixel, (with, without)) in with.iter().zip(&without).enumerate() {
        if *without > 0.0 {
            let ratio = f64::from(*with) / f64::from(*without) * level / middle(pixel % 48);
            assert!((ratio - 1.0).abs() < 1e-5, "{pixel}: {ratio}");
            seen += 1;
        }
    }
    assert!(seen > 10, "{seen} pixels are lit");
}

fn channel(file: &Path, name: &str) -> Vec<f32> {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
    let image = reader.all_channels().first_valid_layer().all_attributes().from_file(file).expect("an EXR");
    let channels = image.layer_data.channel_data.list;
    let channel = channels.into_iter().find(|channel| channel.name.to_string() == name).expect(name);
    channel.sample_data.values_as_f32().collect()
}

/// Noise is the seed's, whatever the number of threads.
#[test]
fn noise_is_the_same_on_any_number_of_threads() {
    let folder = folder("threads");
    write_scene(&folder, "scene", &json!({}));
    succeed(&folder, "render scene.json -o scene.exr --spp 4");
    for (name, threads, seed) in [("one", 1, 7), ("two", 2, 7), ("other", 2, 8)] {
        let words = format!("develop scene.exr --noise --seed {seed} -o {name}.png --raw {name}.tiff");
        assert!(etalon_with(&folder, &words, threads).status.success());
    }
    for ending in ["png", "tiff"] {
        let [one, two, other] =
            ["one", "two", "other"].map(|name| bytes(&folder, &format!("{name}.{ending}")));
        assert!(one == two, "{ending} depends on the number of threads");
        assert!(one != other, "{ending} ignores the seed");
    }
}

/// PNG, JPEG and TIFF carry the exposure where other programs look for it.
#[test]
fn pictures_carry_exif() {
    use exif::{In, Tag, Value as Field};
    let folder = folder("exif");
    write_scene(&folder, "scene", &json!({ "shutter_s": 0.011_111_111_111 }));
    succeed(&folder, "render scene.json -o scene.exr --spp 1");
    for ending in ["png", "jpg", "tiff"] {
        succeed(&folder, &format!("develop scene.exr -o out.{ending} --iso 100000 --f-stop 5.6"));
        let file = std::fs::File::open(folder.join(format!("out.{ending}"))).expect("written");
        let exif = exif::Reader::new()
            .read_from_container(&mut std::io::BufReader::new(file))
            .unwrap_or_else(|e| panic!("{ending}: {e}"));
        let field =
            |tag| &exif.get_field(tag, In::PRIMARY).unwrap_or_else(|| panic!("{ending}: {tag}")).value;
        let fraction = |tag| match field(tag) {
            Field::Rational(values) => (values[0].num, values[0].denom),
            other => panic!("{ending}: {other:?}"),
        };
        let ascii = |tag| match field(tag) {
            Field::Ascii(words) => String::from_utf8(words[0].clone()).expect("ASCII"),
            other => panic!("{ending}: {other:?}"),
        };
        assert_eq!(fraction(Tag::ExposureTime), (1, 90), "{ending}");
        assert_eq!(fraction(Tag::FNumber), (28, 5), "{ending}");
        assert_eq!(fraction(Tag::FocalLength), (25, 1), "{ending}");
        // Two bytes hold no more; the speed itself stands beside it.
        assert_eq!(field(Tag::PhotographicSensitivity).get_uint(0), Some(65_535), "{ending}");
        assert_eq!(field(Tag::ISOSpeed).get_uint(0), Some(100_000), "{ending}");
        assert_eq!(field(Tag::ColorSpace).get_uint(0), Some(1), "{ending}");
        assert_eq!(ascii(Tag::Software), concat!("etalon ", env!("CARGO_PKG_VERSION")), "{ending}");
        assert_eq!(ascii(Tag::ImageDescription), "sound", "{ending}");
        let picture = image::open(folder.join(format!("out.{ending}"))).expect("a picture");
        assert_eq!([picture.width(), picture.height()], [48, 32], "{ending}");
    }
}

/// A developed EXR says what luminance its 1 is, in which primaries, and how it was exposed.
#[test]
fn a_developed_exr_carries_standard_attributes() {
    let folder = folder("exr");
    write_scene(&folder, "scene", &json!({ "electronics": null, "vignetting": null, "white_balance": null }));
    succeed(&folder, "render scene.json -o scene.exr --spp 16");
    succeed(&folder, "develop scene.exr -o out.exr --iso 200 --shutter 1/50 --f-stop 4");
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
    let image = reader.all_channels().first_valid_layer().all_attributes();
    let image = image.from_file(folder.join("out.exr")).expect("an EXR");
    let layer = &image.layer_data.attributes;
    // 78 N^2 / (q S t), ISO 12232.
    let white: f64 = 78.0 * 16.0 / (0.65 * 200.0 * 0.02);
    assert!((f64::from(layer.white_luminance.expect("whiteLuminance")) / white - 1.0).abs() < 1e-6);
    assert_eq!([layer.exposure, layer.aperture, layer.iso_speed], [Some(0.02), Some(4.0), Some(200.0)]);
    let focal_length = layer.other.get(&exr::prelude::Text::from("focalLength"));
    assert_eq!(focal_length, Some(&AttributeValue::F32(25.0)));
    let red = image.attributes.chromaticities.expect("chromaticities").red;
    assert_eq!([red.x(), red.y()], [0.64, 0.33]);
    // (1, 1, 1) has the luminance that whiteLuminance says: Y comes back from R, G, B.
    let [r, g, b] = ["R", "G", "B"].map(|name| channel(&folder.join("out.exr"), name));
    let luminance = channel(&folder.join("scene.exr"), "Y");
    let brightest =
        (0..luminance.len()).max_by(|a, b| luminance[*a].total_cmp(&luminance[*b])).expect("pixels");
    let [r, g, b] = [r, g, b].map(|plane| f64::from(plane[brightest]));
    let back = white * (0.2126 * r + 0.7152 * g + 0.0722 * b);
    let truth = f64::from(luminance[brightest]);
    assert!(truth > 0.0 && (back / truth - 1.0).abs() < 1e-3, "{back} against {truth}");
    let message = fail_in_one_line(&folder, "develop out.exr -o again.png");
    assert!(message.contains("no attribute \"etalon\""), "{message}");
}

/// The digital values are whole, start at the black level and end at the largest.
#[test]
fn raw_values_are_those_of_the_converter() {
    let folder = folder("raw");
    write_scene(&folder, "scene", &json!({}));
    succeed(&folder, "render scene.json -o scene.exr --spp 4");
    succeed(
        &folder,
        "develop scene.exr -o out.png --raw raw.tiff --shutter 1 --iso 6400 --without dark_current",
    );
    let raw = image::open(folder.join("raw.tiff")).expect("a TIFF").into_rgb16();
    assert_eq!(raw.as_raw().iter().max(), Some(&4095));
    assert_eq!(raw.as_raw().iter().min(), Some(&64));
    // A single channel and seven are pages of grey.
    let filters = json!({ "B450": "cornell-filter-450", "B550": "cornell-filter-550" });
    write_scene(
        &folder,
        "bands",
        &json!({
        "sensor": { "filter_set": { "filters": filters, "detector": { "quantum_efficiency": 1 } } } }),
    );
    succeed(&folder, "render bands.json -o bands.exr --spp 1");
    succeed(&folder, "develop bands.exr -o bands.png --raw bands.tiff");
    let file = std::fs::File::open(folder.join("bands.tiff")).expect("written");
    let mut decoder = tiff::decoder::Decoder::new(std::io::BufReader::new(file)).expect("a TIFF");
    const PAGE_NAME: u16 = 285;
    for (page, name) in ["sensor.B450", "sensor.B550"].into_iter().enumerate() {
        let called = decoder.get_tag_ascii_string(tiff::tags::Tag::Unknown(PAGE_NAME)).expect("a name");
        assert_eq!(called, name);
        assert_eq!(decoder.more_images(), page == 0);
        if page == 0 {
            decoder.next_image().expect("another page");
        }
    }
}

/// `check`, the report, the EXR and `develop` list the same chain.
#[test]
fn the_chain_is_listed_everywhere() {
    let folder = folder("stages");
    write_scene(&folder, "scene", &json!({ "noise": {} }));
    succeed(&folder, "render scene.json -o scene.exr --spp 1 --report report.json");
    let report: Value = serde_json::from_slice(&bytes(&folder, "report.json")).expect("JSON");
    let stages = report["camera"]["stages"].as_array().expect("a list");
    let names: Vec<&str> = stages.iter().map(|stage| stage["name"].as_str().expect("text")).collect();
    assert_eq!(
        names,
        [
            "lens_transmission",
            "vignetting",
            "exposure",
            "sensitivity",
            "electrons",
            "full_well",
            "dark_current",
            "shot_noise",
            "read_noise",
            "digital_values",
            "white_balance",
            "matrix",
            "tone",
        ]
    );
    let check = succeed(&folder, "check scene.json");
    let developed = succeed(&folder, "develop scene.exr -o out.png");
    for stage in stages {
        let [name, what] = ["name", "what"].map(|key| stage[key].as_str().expect("text"));
        let on = stage["on"].as_bool().expect("a switch");
        assert_eq!(on, name != "lens_transmission", "{name}");
        let state = if on { "on" } else { "off" };
        assert!(check.contains(&format!("stage      {name}: {state}, {what}")), "{check}");
        assert!(developed.contains(&format!("{name:<18} {state:<3}  {what}")), "{developed}");
    }
    assert!(report["camera"]["saturated_pixels"].is_u64());
    assert!(developed.contains("saturated "), "{developed}");
    let off = succeed(&folder, "develop scene.exr -o out.png --without shot_noise --without vignetting");
    for name in ["shot_noise", "vignetting"] {
        assert!(off.contains(&format!("{name:<18} off")), "{off}");
    }
}

/// Without a matrix a sensor's electronics are in the raw values alone, and every list says so.
#[test]
fn electronics_beside_the_picture_are_listed_as_off() {
    let folder = folder("beside");
    write_scene(&folder, "scene", &json!({ "sensor": "nikon-5100", "noise": {} }));
    let warning = "noise is in the raw values only";
    let rendering = etalon(&folder, "render scene.json -o scene.exr --spp 1");
    assert!(text(&rendering.stderr).contains(warning), "{}", text(&rendering.stderr));
    let check = succeed(&folder, "check scene.json");
    let developing = etalon(&folder, "develop scene.exr -o plain.png");
    assert!(text(&developing.stderr).contains(warning), "{}", text(&developing.stderr));
    let developed = text(&developing.stdout);
    for name in ["electrons", "full_well", "dark_current", "shot_noise", "read_noise", "digital_values"] {
        assert!(check.contains(&format!("stage      {name}: off, raw values only: ")), "{check}");
        assert!(developed.contains(&format!("{name:<18} off  raw values only: ")), "{developed}");
    }
    assert!(check.contains("stage      matrix: off, none is given"), "{check}");
    // They are off indeed: the picture without them is the same.
    let off = succeed(&folder, "develop scene.exr -o off.png --without electrons");
    assert!(off.contains("no electronics are stated"), "{off}");
    let pixels = |name: &str| image::open(folder.join(name)).expect("a picture").into_rgb8();
    assert_eq!(pixels("plain.png"), pixels("off.png"));
    let shown = succeed(&folder, "develop scene.exr -o fitted.png --matrix fitted --white-balance d65");
    assert!(shown.contains("shot_noise         on ") && shown.contains("matrix             on "), "{shown}");
}

#[test]
fn a_new_f_stop_leaves_the_depth_of_field_and_says_so() {
    let folder = folder("depth");
    write_scene(&folder, "scene", &json!({ "focus_distance": 5 }));
    succeed(&folder, "render scene.json -o scene.exr --spp 1");
    let output = etalon(&folder, "develop scene.exr -o out.png --f-stop 2.8");
    assert!(output.status.success());
    let said = text(&output.stderr);
    assert!(
        said.starts_with("warning: the depth of field is that of f/8") && said.lines().count() == 1,
        "{said}"
    );
    succeed(&folder, "develop scene.exr -o out.png --f-stop 8 --iso 800");
    let output = etalon(&folder, "develop scene.exr -o out.png --shutter 10");
    assert!(text(&output.stderr).contains("reciprocity"), "{}", text(&output.stderr));
}

#[test]
fn what_cannot_be_developed_is_refused_in_one_line() {
    let folder = folder("refused");
    write_scene(&folder, "scene", &json!({}));
    write_scene(&folder, "plain", &json!({ "electronics": null }));
    succeed(&folder, "render scene.json -o scene.exr --spp 1 --png scene.png");
    succeed(&folder, "render plain.json -o plain.exr --spp 1");
    write_scene(&folder, "nikon", &json!({ "sensor": "nikon-5100" }));
    succeed(&folder, "render nikon.json -o nikon.exr --spp 1");
    let filters = json!({ "B450": "cornell-filter-450", "B550": "cornell-filter-550" });
    write_scene(
        &folder,
        "bands",
        &json!({
        "sensor": { "filter_set": { "filters": filters, "detector": { "quantum_efficiency": 1 } } } }),
    );
    succeed(&folder, "render bands.json -o bands.exr --spp 1");
    let whole = bytes(&folder, "scene.exr");
    for (name, length) in [("cut-header.exr", 300), ("cut-pixels.exr", whole.len() - 200), ("empty.exr", 0)] {
        std::fs::write(folder.join(name), &whole[..length]).expect("written");
    }
    // A record that was changed by hand: as many bytes, other words.
    let tampered = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let place = whole.windows(from.len()).position(|part| part == from.as_bytes()).expect(from);
        let mut bytes = whole.clone();
        bytes[place..place + to.len()].copy_from_slice(to.as_bytes());
        bytes
    };
    std::fs::write(folder.join("negative.exr"), tampered("\"iso\":400.0", "\"iso\":-40.0")).expect("written");
    std::fs::write(folder.join("bits.exr"), tampered("\"bit_depth\":12", "\"bit_depth\":99"))
        .expect("written");
    std::fs::write(folder.join("older.exr"), tampered("\"tan_half_extent\"", "\"tan-half-extent\""))
        .expect("written");
    std::fs::write(folder.join("size.exr"), tampered("\"resolution\":[48,", "\"resolution\":[47,"))
        .expect("written");
    std::fs::write(folder.join("matrix.json"), "{\"to\": \"srgb\",\n \"rows\": [[1, 0], [0, 1], [0, 0]]}")
        .expect("written");
    std::fs::write(folder.join("broken.json"), "{\"to\": \"srgb\",\n \"rows\": [[1, 0]").expect("written");
    let rows =
        |first: &str| format!("{{\"to\": \"srgb\", \"rows\": [[{first}, 0, 0], [0, 1, 0], [0, 0, 1]]}}");
    for (name, text) in [
        ("list.json", "[]".to_owned()),
        ("word.json", rows("\"one\"")),
        ("number.json", "3".to_owned()),
        ("large.json", rows("-1.1e6")),
    ] {
        std::fs::write(folder.join(name), text).expect("written");
    }
    for (words, file, said) in [
        ("nowhere.exr", "nowhere.exr", "cannot read the render"),
        ("scene.png", "scene.png", "cannot be decoded"),
        ("empty.exr", "empty.exr", "cannot be decoded"),
        ("cut-header.exr", "cut-header.exr", "cannot be decoded"),
        ("cut-pixels.exr", "cut-pixels.exr", "cannot be decoded"),
        ("negative.exr", "negative.exr", "iso of -40 is not a positive number"),
        ("bits.exr", "bits.exr", "electronics are those of no sensor"),
        ("scene.exr --iso 1e300", "", "would be white; check --iso"),
        ("older.exr", "older.exr", "missing field `tan_half_extent`"),
        ("size.exr", "size.exr", "it has 48 x 32 pixels, but its facts say 47 x 32"),
        ("plain.exr --noise", "plain.exr", "states no electronics; add electronics"),
        ("nikon.exr --noise", "nikon.exr", "no noise would be seen"),
        ("scene.exr --seed 3", "scene.exr", "a seed without noise; add --noise"),
        ("plain.exr --raw raw.tiff", "plain.exr", "no digital values; add electronics"),
        ("scene.exr --matrix matrix.json", "matrix.json", "2 numbers for 3 channels"),
        ("scene.exr --matrix broken.json", "broken.json:2:16", "EOF"),
        ("nikon.exr --matrix fitted", "nikon.exr", "a matrix is fitted to a white"),
        ("bands.exr --matrix fitted --white-balance d65", "bands.exr", "and the sensor has 2"),
        (
            "scene.exr --matrix list.json",
            "list.json",
            "a list where an object with \"to\" and \"rows\" belongs",
        ),
        ("scene.exr --matrix word.json", "word.json:1:30", "string \"one\" where a number belongs"),
        ("scene.exr --matrix number.json", "number.json:1:1", "where an object with"),
        ("scene.exr --matrix large.json", "large.json", "-1.1e6 is no entry of a colour matrix"),
        ("scene.exr --noise --without electrons", "scene.exr", "no stage that makes it is on"),
        (
            "scene.exr --noise --without shot_noise --without read_noise",
            "scene.exr",
            "no stage that makes it is on",
        ),
        ("scene.exr --white-balance cornell-white", "", "is no light, it is of the kind reflectance"),
        ("scene.exr --white-balance cornell-filter-550", "", "is no light, it is of the kind transmission"),
        ("scene.exr --matrix none.json", "none.json", "cannot read the matrix"),
        ("scene.exr --white-balance d66", "", "unknown spectrum \"d66\""),
    ] {
        let line = fail_in_one_line(&folder, &format!("develop {words} -o out.png"));
        assert!(line.starts_with(&format!("error: {file}")) && line.contains(said), "{line}");
        assert!(line.contains("; "), "nothing to do: {line}");
    }
    for (words, said) in [
        ("-o out.bmp", "a developed picture is a PNG, a TIFF, a JPEG or an EXR"),
        ("-o nowhere/out.png", "the folder of the output does not exist"),
        ("-o scene.exr", "the picture would replace the render"),
        ("-o out.exr --tone srgb", "an EXR holds linear values"),
        ("-o out.tiff --raw out.tiff", "would be the same file"),
        ("-o out.tiff --raw ./out.tiff", "would be the same file"),
        ("-o out.png --raw raw.png", "digital values are written as a TIFF"),
    ] {
        let line = fail_in_one_line(&folder, &format!("develop scene.exr {words}"));
        assert!(line.contains(said), "{line}");
    }
    for (words, said) in [
        ("--shutter 1/0", "give positive seconds, such as 1/60 or 0.5"),
        ("--shutter fast", "give positive seconds"),
        ("--iso -100", "-1"),
        ("--iso inf", "give a positive number"),
        ("--f-stop 0", "give a positive number"),
        ("--anchor saturated", "did you mean \"saturation\"?"),
        ("--tone gamma=0", "give a positive number"),
        ("--tone rgb", "did you mean \"srgb\"?"),
        ("--without noise", "unknown stage \"noise\""),
    ] {
        let said_here = fail(&folder, &format!("develop scene.exr -o out.png {words}"));
        assert!(said_here.contains(said), "{said_here}");
    }
    assert!(!folder.join("out.png").exists());
}
