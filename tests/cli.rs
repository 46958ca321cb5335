//! The program as a user meets it: its messages, its files, its exit codes.

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// A fault in a file is reported within this time.
const PROMPT: Duration = Duration::from_secs(1);

/// Runs the program in the project's folder.
fn etalon<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments);
    command.output().expect("the program starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the program writes UTF-8")
}

/// Standard output of a run that must succeed and complain of nothing.
fn succeed<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> String {
    let output = etalon(arguments);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{}", text(&output.stdout));
    text(&output.stdout).to_owned()
}

/// What a run says that must fail at once, by the user's fault, without having printed anything.
fn fail<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> String {
    let started = Instant::now();
    let output = etalon(arguments);
    let elapsed = started.elapsed();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.starts_with("error: "), "{message}");
    assert!(!message.contains("panicked"), "{message}");
    assert_eq!(text(&output.stdout), "", "{message}");
    assert!(elapsed < PROMPT, "{elapsed:?} for {message}");
    message.to_owned()
}

/// The same, of a run that must say it in one line.
fn fail_in_one_line<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> String {
    let message = fail(arguments);
    let line = message.strip_suffix('\n').expect("the line ends");
    assert!(!line.contains(char::is_control), "{message:?}");
    line.to_owned()
}

/// An empty folder for one test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{test}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn json(file: &Path) -> Value {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

/// Every scene of `reference/`.
fn reference_scenes() -> Vec<PathBuf> {
    let folders = std::fs::read_dir(root().join("reference")).expect("the references are there");
    let scenes = folders.map(|entry| entry.expect("readable").path().join("scene.json"));
    let scenes: Vec<PathBuf> = scenes.filter(|scene| scene.is_file()).collect();
    assert!(scenes.len() >= 6, "{scenes:?}");
    scenes
}

/// Files with one fault each: the place that must be named (in the scene itself where it
/// begins with a colon), the pointer, and parts of what is wrong and of what to do.
macro_rules! faults {
    ($($test:ident: $place:literal, $pointer:literal, $what:literal, $remedy:literal;)*) => {
        mod malformed {
            $(
                #[test]
                fn $test() {
                    super::check_fault(stringify!($test), $place, $pointer, $what, $remedy);
                }
            )*
        }
        const FAULTS: &[&str] = &[$(stringify!($test)),*];
    };
}

faults! {
    syntax_missing_comma: ":27:5", "/camera", "not valid JSON", "check commas";
    syntax_unclosed: ":21:1", "/camera", "not valid JSON: EOF", "brackets";
    syntax_trailing_text: ":30:1", "/", "not valid JSON: trailing characters", "check";
    syntax_empty_file: ":1:1", "/", "not valid JSON: EOF", "check";
    key_unknown: ":25:5", "/camera", "unknown key \"fstop\"", "did you mean \"f_stop\"?";
    key_unknown_at_the_root: ":10:3", "/", "unknown key \"objets\"", "did you mean \"objects\"?";
    key_unknown_in_a_shape: ":13:49", "/objects/0/shape/sphere", "unknown key \"radus\"", "did you mean \"radius\"?";
    key_missing: ":18:3", "/camera", "the key \"f_stop\" is missing", "add it";
    key_missing_at_the_root: ":1:1", "/", "the key \"length_unit\" is missing", "add it";
    key_twice: ":28:5", "/camera", "the key \"f_stop\" stands twice", "remove or rename";
    key_twice_in_spectra: ":6:5", "/spectra", "the key \"grey\" stands twice", "remove or rename";
    variant_unknown: ":8:15", "/materials/white", "unknown key \"lambertain\"", "did you mean \"lambertian\"?";
    variant_unknown_unit: ":3:3", "/length_unit", "unknown value \"inch\"", "m, cm, mm";
    variant_two_in_one: ":13:7", "/objects/0/shape", "one key that says which kind is meant", "`etalon schema`";
    variant_is_a_number: ":13:7", "/objects/0/shape", "one key that says which kind is meant", "`etalon schema`";
    type_wrong: ":25:5", "/camera/f_stop", "string \"f/8\" where a number belongs", "`etalon schema`";
    type_fraction_of_a_pixel: ":24:24", "/camera/resolution/1", "number 24.5 where a whole number from 0 up belongs", "`etalon schema`";
    type_null: ":8:30", "/materials/white/lambertian/reflectance", "null where a number, the name of a spectrum, or a description", "`etalon schema`";
    list_too_short: ":21:5", "/camera/up", "a list of 2 where a list of 3 belongs", "`etalon schema`";
    list_too_long: ":21:5", "/camera/up", "the list has more entries than belong here", "`etalon schema`";
    name_of_no_material: ":14:7", "/objects/0/material", "unknown material \"wite\"", "did you mean \"white\"?";
    name_of_no_spectrum: ":8:30", "/materials/white/lambertian/reflectance", "unknown spectrum \"cornel-white\"", "did you mean \"cornell-white\"?";
    name_of_no_glass: ":8:30", "/materials/white/dielectric/index", "unknown glass \"n-bk8\"", "did you mean \"n-bk7\"?";
    name_of_no_metal: ":8:29", "/materials/white/conductor/metal", "unknown metal \"golt\"", "did you mean \"gold\"?";
    name_of_no_sensor: ":28:5", "/camera/sensor", "unknown sensor \"cie1931\"", "did you mean \"cie-1931\"?";
    name_of_a_reflectance_as_sensor: ":28:5", "/camera/sensor", "unknown sensor \"cornell-white\"", "";
    name_with_a_slash: ":9:34", "/materials/wall~1left/lambertian/reflectance", "a reflectance of 2 is above 1", "between 0 and 1";
    name_with_a_line_break: ":14:7", "/objects/0/material", "unknown material \"a\\nb\"", "known: white";
    reflectance_negative: ":8:30", "/materials/white/lambertian/reflectance", "a reflectance of -0.1 is negative", "between 0 and 1";
    reflectance_negative_in_a_csv: "negative.csv:3:5", "/materials/white/lambertian/reflectance", "a reflectance of -0.01 is negative", "clipped in the table";
    reflectance_above_1: ":8:30", "/materials/white/lambertian/reflectance", "a reflectance of 80 is above 1", "per cent";
    mirror_above_1: ":8:26", "/materials/white/mirror/reflectance", "a reflectance of 1.01 is above 1", "between 0 and 1";
    emission_negative: ":15:20", "/objects/0/emission/spectrum", "an emission of -1 is negative", "from 0 up";
    absorption_too_large: ":8:44", "/materials/white/dielectric/absorption_per_m", "an absorption of 1e39 is too large", "check the unit";
    csv_nan: "nan.csv:4:5", "/spectra/grey/csv/file", "\"nan\" is not a finite number", "write numbers";
    csv_out_of_order: "out-of-order.csv:5:1", "/spectra/grey/csv/file", "500 nm comes after 600 nm", "sort the rows";
    csv_row_too_short: "row-too-short.csv:3:1", "/spectra/grey/csv/file", "the row has 1 cells, the header 2", "one cell per column";
    csv_without_numbers: "without-numbers.csv:1:1", "/spectra/grey/csv/file", "the table holds no numbers", "header row";
    csv_missing: ":5:22", "/spectra/grey/csv/file", "cannot read \"nowhere.csv\": No such file or directory", "relative to the scene's folder";
    csv_is_a_folder: ":5:22", "/spectra/grey/csv/file", "cannot read \".\"", "name a file, not a folder";
    csv_column_unknown: ":5:48", "/spectra/grey/csv/column", "unknown column \"left\"", "a, b";
    csv_column_not_named: ":5:14", "/spectra/grey/csv", "more than one curve", "name a column: a, b";
    table_out_of_order: ":5:53", "/spectra/grey/table/wavelengths_nm/2", "500 nm comes after 600 nm", "sort the points";
    table_unequal: ":5:54", "/spectra/grey/table/values", "1 values for 2 wavelengths", "one value per wavelength";
    temperature_0: ":15:47", "/objects/0/emission/spectrum/blackbody/temperature_k", "a temperature of 0 K is not positive", "in kelvin";
    temperature_negative: ":15:47", "/objects/0/emission/spectrum/blackbody/temperature_k", "a temperature of -1 K is not positive", "in kelvin";
    spectra_in_a_circle: ":7:22", "/spectra/b/scaled/spectrum", "in a circle: \"a\", \"b\", \"a\"", "let one of them be";
    spectrum_named_by_itself: ":5:5", "/spectra/grey", "in a circle: \"grey\", \"grey\"", "let one of them be";
    spectrum_unused_and_wrong: ":6:25", "/spectra/idle/scaled/spectrum", "unknown spectrum \"nosuch\"", "";
    lines_negative: ":15:76", "/objects/0/emission/spectrum/lines/lines/0/power", "the line at 589 nm has a power of -2", "from 0 up";
    lines_scaled_negative: ":15:20", "/objects/0/emission/spectrum", "an emission of -2 is negative", "from 0 up";
    lines_twice: ":15:90", "/objects/0/emission/spectrum/lines/lines/1/wavelength_nm", "the line at 589 nm stands twice", "sum of its powers";
    lines_at_0_nm: ":15:54", "/objects/0/emission/spectrum/lines/lines/0/wavelength_nm", "a line at 0 nm", "above 0, in nm";
    lines_none: ":15:43", "/objects/0/emission/spectrum/lines/lines", "the list holds no line", "at least one";
    lines_without_power: ":15:53", "/objects/0/emission/spectrum/lines/lines/0", "the key \"power\" is missing", "add it";
    lines_misspelt: ":15:54", "/objects/0/emission/spectrum/lines/lines/0", "unknown key \"wavelenght_nm\"", "did you mean \"wavelength_nm\"?";
    lines_on_lines: ":15:43", "/objects/0/emission/spectrum/lines/continuum", "the continuum has lines itself", "into one list";
    lines_in_a_circle: ":5:24", "/spectra/grey/lines/continuum", "in a circle: \"grey\", \"grey\"", "let one of them be";
    lines_invisible: ":15:105", "/objects/0/emission/level/flux_lm", "no visible light", "radiant_power";
    lines_as_reflectance: ":8:30", "/materials/white/lambertian/reflectance", "spectral lines where no light is given off", "belong in an emission";
    sellmeier_pole: ":8:30", "/materials/white/dielectric/index", "pole at 550.00 nm", "check the unit";
    sellmeier_negative_square: ":8:30", "/materials/white/dielectric/index", "Sellmeier's formula gives n^2 = -2.25", "check the coefficients";
    sellmeier_unequal: ":8:71", "/materials/white/dielectric/index/sellmeier/c_um2", "2 coefficients b but 1 c_um2", "one c_um2 for each b";
    index_table_too_narrow: ":8:30", "/materials/white/dielectric/index", "known from 400 to 700 nm", "covers 360 to 830 nm";
    index_outside_0: ":8:44", "/materials/white/dielectric/outside_index", "the refractive index at 360 nm is 0", "above 0";
    roughness_above_1: ":8:46", "/materials/white/conductor/roughness_alpha", "a roughness alpha of 1.5 is outside 0 to 1", "0.1 satin";
    coordinate_1e400: ":13:42", "/objects/0/shape/sphere/center/1", "a number is too large", "below 1e308";
    coordinate_1e39: ":13:42", "/objects/0/shape/sphere/center/1", "a length of 1e39 is too large", "length unit";
    coordinate_1e39_of_a_quad: ":13:68", "/objects/0/shape/quad/vertices/2/2", "a length of -1e39 is too large", "length unit";
    camera_at_1e39: ":19:24", "/camera/position/2", "a length of -1e39 is too large", "length unit";
    radius_0: ":13:49", "/objects/0/shape/sphere/radius", "a radius of 0 is not positive", "above 0";
    radius_negative: ":13:49", "/objects/0/shape/sphere/radius", "a radius of -0.1 is not positive", "above 0";
    quad_without_area: ":13:17", "/objects/0/shape/quad", "the quad has no extent", "spread its points";
    quad_crossed: ":13:17", "/objects/0/shape/quad", "cross each other", "exchange two vertices";
    box_flat: ":13:54", "/objects/0/shape/box/max/1", "from 0 to 0 along y", "larger number in max";
    disk_without_normal: ":13:47", "/objects/0/shape/disk/normal", "must be finite and not zero", "[0, 0, 1]";
    sphere_stretched: ":14:7", "/objects/0/transform", "a sphere stays a sphere only under", "by the same factor";
    transform_flat: ":14:48", "/objects/0/transform/1/scale", "flattens space", "factors of 0";
    mesh_empty: ":13:73", "/objects/0/shape/mesh/triangles", "the mesh has no extent", "";
    mesh_bad_index: ":13:98", "/objects/0/shape/mesh/triangles/1", "names vertex 3, but there are only 3", "numbered from 0";
    mesh_missing: ":13:25", "/objects/0/shape/ply/file", "cannot read \"nowhere.ply\": No such file or directory", "relative to the scene's folder";
    ply_empty: "empty.ply:7:1", "/objects/0/shape/ply/file", "the file holds no face", "check the mesh";
    ply_bad_index: "bad-index.ply:13:7", "/objects/0/shape/ply/file", "the face names vertex 7, but there are 3 vertices", "check the mesh";
    obj_bad_index: "bad-index.obj:5:7", "/objects/0/shape/obj/file", "the face names vertex 4, but there are 3 vertices", "check the mesh";
    obj_empty: "empty.obj:1:1", "/objects/0/shape/obj/file", "the file holds no face", "check the mesh";
    level_luminance_of_a_point: ":19:81", "/lights/0/point/emission/level/luminance_cd_m2", "luminance_cd_m2 describes a surface", "give flux_lm";
    profile_lists_unequal: ":19:111", "/lights/0/point/distribution/profile/relative_intensity", "2 angles and 3 intensities", "angles_deg";
    profile_angles_fall: ":19:88", "/lights/0/point/distribution/profile/angles_deg", "do not rise within 0 to 180 degrees", "angles_deg";
    level_intensity_of_a_box: ":15:49", "/objects/0/emission/level/intensity_cd", "depends on the direction", "give flux_lm";
    level_negative: ":15:49", "/objects/0/emission/level/flux_lm", "-1 is not a finite number from 0 up", "from 0 up";
    level_too_bright: ":15:49", "/objects/0/emission/level/luminance_cd_m2", "too bright for 32-bit numbers", "check the unit";
    level_lumens_of_the_invisible: ":15:104", "/objects/0/emission/level/flux_lm", "no visible light", "radiant_power";
    level_two_at_once: ":15:39", "/objects/0/emission/level", "one key that says which kind is meant", "`etalon schema`";
    band_empty: ":15:81", "/objects/0/emission/level/radiant_power/band_nm", "the band from 500 to 500 nm is empty", "[360, 830]";
    band_dark: ":15:49", "/objects/0/emission/level/radiant_power", "dark within the band", "widen band_nm";
    band_misspelt: ":15:81", "/objects/0/emission/level/radiant_power/band_nm", "a band is [from, to] in nm, or \"all\"", "`etalon schema`";
    camera_looks_nowhere: ":18:3", "/camera", "the camera looks nowhere", "add look_at or direction";
    camera_looks_twice: ":21:5", "/camera/direction", "both look_at and direction", "keep one";
    camera_looks_at_itself: ":20:5", "/camera/look_at", "looks at its own position", "move look_at";
    camera_up_along_the_view: ":21:5", "/camera/up", "up is along the line of sight", "give a direction across it";
    camera_focus_too_near: ":26:5", "/camera/focus_distance", "a lens of 50 mm cannot focus at 0.05", "farther away";
    camera_shutter_0: ":26:5", "/camera/shutter_s", "0 is not a positive number", "1/90 s";
    camera_iso_negative: ":27:5", "/camera/iso", "-100 is not a positive number", "100";
    camera_sensor_0: ":23:23", "/camera/sensor_mm/1", "0 is not a positive number", "[36, 24]";
    camera_resolution_0: ":24:5", "/camera/resolution", "a picture of 0 by 24 pixels", "at least 1";
    camera_white_is_black: ":28:5", "/camera/white_balance", "a white without visible light", "d65";
    bits_17: ":28:78", "/camera/electronics/bit_depth", "17 bits", "1 to 16 bits";
    bits_without_gain: ":28:48", "/camera/electronics/bit_depth", "digital values without a gain", "full_well_electrons";
    black_level_above_white: ":28:87", "/camera/electronics/black_level_dn", "a black level of 256 is not below the largest value of 8 bits", "check black_level_dn";
    detector_negative: ":28:68", "/camera/sensor/filter_set/detector/relative_responsivity", "a response of -1 is negative", "from 0 up";
    electronics_misspelt: ":28:21", "/camera/electronics", "unknown key \"quantum_eficiency\"", "did you mean \"quantum_efficiency\"?";
    filter_above_1: ":28:43", "/camera/sensor/filter_set/filters/B550", "a transmission of 2 is above 1", "between 0 and 1";
    filter_misnamed: ":28:31", "/camera/sensor/filter_set/filters", "the filter \"550 nm\" cannot name a channel", "letters and digits";
    filter_unknown: ":28:43", "/camera/sensor/filter_set/filters/B550", "unknown spectrum \"cornell-filter-551\"", "did you mean \"cornell-filter-550\"?";
    filter_without_detector: ":28:16", "/camera/sensor/filter_set", "the key \"detector\" is missing", "add it";
    filters_alike: ":28:31", "/camera/sensor/filter_set/filters", "two filters are called B", "rename one";
    filters_none: ":28:31", "/camera/sensor/filter_set/filters", "the filter set is empty", "a transmission for each channel";
    flat_field_missing: ":28:35", "/camera/vignetting/flat_field/file", "cannot read \"nowhere.png\"", "relative to the scene's folder";
    flat_field_no_picture: ":28:35", "/camera/vignetting/flat_field/file", "cannot be decoded", "linear in light";
    full_well_0: ":28:48", "/camera/electronics/full_well_electrons", "0 is not a positive number", "30000";
    gain_without_bits: ":28:48", "/camera/electronics/electrons_per_dn", "a gain without digital values", "add bit_depth";
    gamma_0: ":28:30", "/camera/development/tone/gamma", "a gamma of 0 is not a positive number", "2.2";
    lens_above_1: ":28:5", "/camera/lens_transmission", "a transmission of 1.2 is above 1", "between 0 and 1";
    lens_and_constant: ":28:31", "/camera/exposure_constant_q", "both exposure_constant_q and lens_transmission", "keep one";
    lens_opaque: ":28:5", "/camera/lens_transmission", "the lens passes no light", "check lens_transmission";
    matrix_of_one_channel: ":28:111", "/camera/development/fit_matrix", "a matrix is fitted to three channels, and the sensor has 1", "give the matrix itself";
    matrix_of_two_rows: ":28:45", "/camera/development/matrix/rows", "a matrix of 2 rows", "three rows";
    matrix_too_narrow: ":28:66", "/camera/development/matrix/rows/1", "2 numbers for 3 channels", "one number for every channel";
    noise_without_electronics: ":28:5", "/camera/noise", "noise without electronics", "add electronics";
    pixel_pitch_negative: ":28:72", "/camera/electronics/pixel_pitch_um/1", "-4.3 is not a positive number", "[4.3, 4.3]";
    quantum_efficiency_above_1: ":28:21", "/camera/electronics/quantum_efficiency", "a quantum efficiency of 50 is outside 0 to 1", "such as 0.5";
    read_noise_negative: ":28:48", "/camera/electronics/read_noise_electrons", "-3 is not a finite number from 0 up", "leave it out";
    vignetting_below_0: "falls-below-0.csv:4:1", "/camera/vignetting/radial_table/file", "a relative illuminance of -0.1 is not positive", "relative to the axis";
    vignetting_table_wrong: "two-curves.csv:1:1", "/camera/vignetting/radial_table/file", "unknown column \"wavelength_nm\"", "radius_mm, angle_deg";
    vignetting_unknown: ":28:5", "/camera/vignetting", "unknown value \"cos3\"", "did you mean \"cos4\"?";
    meter_without_normal: ":19:61", "/meters/0/illuminance/normal", "must be finite and not zero", "[0, 0, 1]";
    number_nan: ":13:59", "/objects/0/shape/sphere/radius", "not valid JSON: expected value", "write a finite number; JSON knows";
    number_infinite: ":13:60", "/objects/0/shape/sphere/radius", "not valid JSON: invalid number", "write a finite number; JSON knows";
    radius_1e39: ":13:49", "/objects/0/shape/sphere/radius", "a length of 1e39 is too large to be held", "check the number and the scene's";
    syntax_comment: ":18:3", "/", "not valid JSON: key must be a string", "JSON has no comments; write a";
    syntax_trailing_comma: ":28:3", "/camera", "not valid JSON: trailing comma", "check commas, quotes and brackets just";
    text_utf_16: ":1:1", "", "the text is UTF-16", "save the file as UTF-8 text";
    text_latin_1: ":12:22", "", "the byte 0xe0 belongs to no UTF-8 text", "save the file as UTF-8 text";
    text_packed: ":1:1", "", "the file is packed (gzip)", "unpack it and name the file";
    text_of_bytes: ":1:5", "", "the byte 0x9f belongs to no UTF-8 text", "save the file as UTF-8 text";
    camera_resolution_4294967296: ":24:20", "/camera/resolution/0", "number 4294967296 where a whole number below 4294967296 belongs", "`etalon schema` describes what belongs here";
    camera_resolution_too_large: ":24:5", "/camera/resolution", "a picture of 65536 by 65536 pixels", "give width and height, each at";
    reflectance_1e39: ":8:30", "/materials/white/lambertian/reflectance", "a reflectance of 1e39 is above 1", "a reflectance lies between 0 and";
    csv_semicolons: "semicolons.csv:1:14", "/spectra/grey/csv/file", "the columns are not separated by commas", "write commas between columns, and decimals";
    csv_tabs: "tabs.csv:1:14", "/spectra/grey/csv/file", "the columns are not separated by commas", "write commas between columns, and decimals";
    csv_decimal_commas: "decimal-commas.csv:2:1", "/spectra/grey/csv/file", "the row has 3 cells, the header 2", "give every row one cell per";
    csv_micrometres: "micrometres.csv:1:1", "/spectra/grey/csv/file", "the first column is \"wavelength_um\"", "write wavelengths in nanometres there and";
    csv_without_header: "without-header.csv:1:1", "/spectra/grey/csv/file", "the first row must name the columns", "write a header row such as";
    csv_same_column_twice: "same-column-twice.csv:1:21", "/spectra/grey/csv/file", "two columns are called \"value\"", "rename one";
    csv_same_wavelength_twice: "same-wavelength-twice.csv:4:1", "/spectra/grey/csv/file", "wavelengths must rise from row to row, but 500 nm comes after 500 nm", "sort the rows and leave out";
    csv_utf_16: "utf-16.csv:1:1", "/spectra/grey/csv/file", "the text is UTF-16", "save the file as UTF-8 text";
    csv_packed: "packed.csv:1:1", "/spectra/grey/csv/file", "the file is packed (gzip)", "unpack it and name the file";
    csv_infinite: "infinite.csv:3:5", "/spectra/grey/csv/file", "\"1e400\" is not a finite number", "write numbers with a decimal point";
    reflectance_above_1_in_a_csv: "per-cent.csv:4:9", "/materials/white/lambertian/reflectance", "a reflectance of 50 is above 1", "a reflectance lies between 0 and";
    reflectance_negative_in_a_table: ":8:102", "/materials/white/lambertian/reflectance/table/values/1", "a reflectance of -0.5 is negative", "a reflectance lies between 0 and";
    csv_is_a_device: ":5:22", "/spectra/grey/csv/file", "cannot read \"/dev/zero\": it is a device, not a file", "save what it gives to a";
    spectra_too_deep: ":37:24", "/spectra/s31/scaled/spectrum", "spectra name one another more than 32 deep", "give the spectrum itself instead of";
    lists_too_deep: ":13:49", "/objects/0/shape/sphere/radius", "a list where a number belongs", "`etalon schema` describes what belongs here";
    mesh_normal_0: ":13:96", "/objects/0/shape/mesh/normals/1", "a normal of zero length points nowhere", "give a direction, such as [0";
    mesh_normals_too_few: ":13:73", "/objects/0/shape/mesh/normals", "the mesh has 3 vertices but 1 normals", "give one normal per vertex, or";
    ply_cut_short: "cut-short.ply:7:1", "/objects/0/shape/ply/file", "1 items of \"face\" are announced, but the file has room for at most 0", "the file is cut short or";
    ply_cut_short_binary: "cut-short-binary.ply:7:1", "/objects/0/shape/ply/file", "in number 0 of \"face\" counted from 0", "check the mesh, or write it";
    ply_count_of_4e9: "count-of-4e9.ply:3:1", "/objects/0/shape/ply/file", "4000000000 items of \"vertex\" are announc", "the file is cut short or";
    ply_count_negative: "count-negative.ply:3:1", "/objects/0/shape/ply/file", "the header's line \"element vertex -3\" is not understood", "check the mesh, or write it";
    ply_list_of_4e9: "list-of-4e9.ply:7:1", "/objects/0/shape/ply/file", "in number 0 of \"face\" counted from 0", "check the mesh, or write it";
    ply_not_a_number: "not-a-number.ply:11:3", "/objects/0/shape/ply/file", "\"nan\" is not a finite number", "check the mesh, or write it";
    ply_infinite_binary: "infinite-binary.ply:3:1", "/objects/0/shape/ply/file", "a coordinate is not finite, in number 1 of \"vertex\" counted from 0", "check the mesh, or write it";
    ply_without_z: "without-z.ply:3:1", "/objects/0/shape/ply/file", "\"vertex\" lacks one of x, y, z", "check the mesh, or write it";
    ply_no_format: "no-format.ply:1:1", "/objects/0/shape/ply/file", "no line \"format\"", "check the mesh, or write it";
    ply_normal_0: "normal-0.ply:14:7", "/objects/0/shape/ply/file", "a normal of zero length points nowhere", "compute the normals anew, or write";
    ply_index_negative: "index-negative.ply:13:7", "/objects/0/shape/ply/file", "a vertex number is negative or not whole", "check the mesh, or write it";
    ply_index_with_a_fraction: "index-with-a-fraction.ply:13:7", "/objects/0/shape/ply/file", "a vertex number is negative or not whole", "check the mesh, or write it";
    ply_packed: "packed.ply:1:1", "/objects/0/shape/ply/file", "the file is packed (gzip)", "unpack it and name the file";
    ply_of_bytes: "of-bytes.ply:1:1", "/objects/0/shape/ply/file", "the file does not begin with \"ply\"", "check the mesh, or write it";
    obj_not_a_number: "not-a-number.obj:2:7", "/objects/0/shape/obj/file", "\"O\" is not a number", "check the mesh, or write it";
    obj_infinite: "infinite.obj:2:7", "/objects/0/shape/obj/file", "a coordinate is not finite", "check the mesh, or write it";
    obj_coordinate_missing: "coordinate-missing.obj:2:6", "/objects/0/shape/obj/file", "three coordinates are needed", "check the mesh, or write it";
    obj_index_0: "index-0.obj:4:3", "/objects/0/shape/obj/file", "the face names vertex 0, but there are 3 vertices", "check the mesh, or write it";
    obj_index_of_1e18: "index-of-1e18.obj:4:7", "/objects/0/shape/obj/file", "the face names vertex 1000000000000000000, but there are 3 vertices", "check the mesh, or write it";
    obj_index_before_the_first: "index-before-the-first.obj:4:9", "/objects/0/shape/obj/file", "the face names vertex -4, but there are 3 vertices", "check the mesh, or write it";
    obj_two_corners: "two-corners.obj:4:1", "/objects/0/shape/obj/file", "a face needs 3 vertices, found 2", "check the mesh, or write it";
    obj_normal_0: "normal-0.obj:4:1", "/objects/0/shape/obj/file", "a normal of zero length points nowhere", "compute the normals anew, or write";
    obj_unknown_statement: "unknown-statement.obj:4:1", "/objects/0/shape/obj/file", "unknown statement \"curve\"", "check the mesh, or write it";
    obj_packed: "packed.obj:1:1", "/objects/0/shape/obj/file", "the file is packed (gzip)", "unpack it and name the file";
    obj_of_bytes: "of-bytes.obj:1:1", "/objects/0/shape/obj/file", "unknown statement \"\\u{b}0Uz", "check the mesh, or write it";
    obj_length_of_1e39: ":13:25", "/objects/0/shape/obj/file", "\"length-of-1e39.obj\": a length of 1e39 is too large", "check the number";
    mesh_is_a_device: ":13:25", "/objects/0/shape/obj/file", "cannot read \"/dev/zero\": it is a device, not a file", "save what it gives to a";
    mesh_is_a_folder: ":13:25", "/objects/0/shape/ply/file", "cannot read \"../files\": Is a directory", "name a file, not a folder";
}

fn check_fault(test: &str, place: &str, pointer: &str, what: &str, remedy: &str) {
    let scene = format!("tests/files/{}.json", test.replace('_', "-"));
    let place =
        if place.starts_with(':') { format!("{scene}{place}") } else { format!("tests/files/{place}") };
    let line = fail_in_one_line(["check", &scene]);
    let numbers: Vec<&str> = place.rsplit(':').take(2).collect();
    assert!(numbers.iter().all(|number| number.parse::<u32>().is_ok()), "{place} has no line and column");
    // A file that is no text is at fault as a whole, not in one of its entries.
    let beginning = format!("error: {place}{}{pointer}: ", if pointer.is_empty() { "" } else { " " });
    let message = line.strip_prefix(&beginning);
    let message = message.unwrap_or_else(|| panic!("{line}\nshould begin with\n{beginning}"));
    let (fault, advice) = message.split_once("; ").unwrap_or_else(|| panic!("nothing to do: {line}"));
    assert!(fault.contains(what), "{fault}\nshould contain\n{what}");
    assert!(advice.contains(remedy), "{advice}\nshould contain\n{remedy}");
}

#[test]
fn every_malformed_file_has_its_test_and_the_sound_one_passes() {
    let entries = std::fs::read_dir(root().join("tests/files")).expect("the files are there");
    let names = entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
    let scenes: BTreeSet<String> =
        names.filter_map(|name| Some(name.strip_suffix(".json")?.replace('-', "_"))).collect();
    let tested: BTreeSet<String> = FAULTS.iter().copied().chain(["sound"]).map(str::to_owned).collect();
    assert_eq!(scenes, tested);
    let said = succeed(["check", "tests/files/sound.json"]);
    assert!(said.contains("light      lamp: "), "{said}");
}

#[test]
fn rendering_and_measuring_report_the_same_fault_and_write_nothing() {
    let folder = folder("fault");
    let scene = "tests/files/radius-0.json";
    let check = fail_in_one_line(["check", scene]);
    let output = folder.join("out.exr");
    assert_eq!(fail_in_one_line(["render", scene, "-o", output.to_str().expect("UTF-8")]), check);
    assert_eq!(fail_in_one_line(["measure", scene]), check);
    assert_eq!(std::fs::read_dir(folder).expect("readable").count(), 0);
}

#[test]
fn a_scene_that_cannot_be_read_is_named() {
    for (scene, message) in [
        (
            "nowhere.json",
            "error: nowhere.json: cannot read the scene: No such file or directory; check the path",
        ),
        ("tests", "error: tests: cannot read the scene: Is a directory; name a file, not a folder"),
    ] {
        assert_eq!(fail_in_one_line(["check", scene]), message);
    }
    let latin1 = folder("latin-1").join("scene.json");
    std::fs::write(&latin1, b"{\"name\": \"caf\xe9\"}").expect("written");
    let message = fail_in_one_line(["check", latin1.to_str().expect("UTF-8")]);
    assert!(message.ends_with("save the file as UTF-8 text"), "{message}");
}

#[test]
fn a_scene_without_camera_or_meters_says_what_to_add() {
    let folder = folder("no-camera");
    let scene = folder.join("scene.json");
    std::fs::write(&scene, r#"{"name": "bare", "length_unit": "m"}"#).expect("written");
    let (scene, output) = (scene.display().to_string(), folder.join("out.exr").display().to_string());
    let message = fail_in_one_line(["render", &scene, "-o", &output]);
    assert!(message.starts_with(&format!("error: {scene}: ")), "{message}");
    assert!(message.contains("has no camera; add a \"camera\""), "{message}");
    let message = fail_in_one_line(["measure", &scene]);
    assert!(message.contains("the scene has no meters; add for example"), "{message}");
}

#[test]
fn wrong_arguments_are_named_with_what_belongs_there() {
    let render = ["render", "tests/files/sound.json", "-o", "out.exr"];
    for (arguments, said) in [
        (
            vec!["--resolution", "0x24"],
            "'0x24' for '--resolution <WxH>': give width and height as in 640x480",
        ),
        (vec!["--resolution", "640"], "'640' for '--resolution <WxH>': give width and height as in 640x480"),
        (vec!["--resolution", "99999x1"], "give width and height as in 640x480"),
        (vec!["--integrator", "pathh"], "unknown integrator \"pathh\"; did you mean \"path\"?"),
        (vec!["--spp", "0"], "'0' for '--spp <N>'"),
        (vec!["--spp", "-3"], "'-3'"),
        (vec!["--time", "0"], "give a positive number of seconds"),
        (vec!["--time", "nan"], "give a positive number of seconds"),
        (vec!["--time", "5", "--spp", "5"], "cannot be used with"),
        (vec!["--error", "0"], "give a share between 0 and 1, such as 0.01 or 1%"),
        (vec!["--error", "120%"], "give a share between 0 and 1, such as 0.01 or 1%"),
        (vec!["--error", "1%", "--strategies", "shown"], "cannot be used with"),
        (vec!["--resume"], "--checkpoint <FILE>"),
        (vec!["--checkpoint", "kept", "--checkpoint-interval=-1"], "give a number of seconds from 0 up"),
        (vec!["--checkpoint", "out.exr"], "out.exr: the checkpoint would overwrite the picture"),
        (vec!["--checkpoint", "nowhere/kept"], "nowhere/kept: the folder of the output does not exist"),
        (vec!["--checkpoint", "tests", "--resume"], "tests: the output is a folder; choose another name"),
        (vec!["--threads", "0"], "'0' for '--threads <N>'"),
        (vec!["--seed", "1.5"], "'1.5' for '--seed <N>'"),
        (vec!["--spectral-layers", "0"], "'0' for '--spectral-layers <N>'"),
        (vec!["--sp", "5"], "'--sp'"),
    ] {
        let message = fail(render.into_iter().chain(arguments));
        assert!(message.contains(said), "{message}");
    }
    assert!(!root().join("out.exr").exists());
    assert!(fail(["rendr"]).contains("'render'"));
    assert_eq!(
        fail_in_one_line(["validate", "cornel"]),
        "error: unknown case \"cornel\"; did you mean \"cornell\"?"
    );
    for words in [
        "--seed 3",
        "--integrator bdpt",
        "--photos .",
        "--bands .",
        "--bands . --points points.csv",
        "--photo photo.png",
        "--force-registration",
        "--time 5",
        "--error 1%",
    ] {
        let message = fail_in_one_line(["validate", "self-test"].into_iter().chain(words.split(' ')));
        let option = words.split(' ').next().expect("an option");
        assert!(message.contains(&format!("the self-test does not take {option};")), "{message}");
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_rendering() {
    let folder = folder("outputs");
    let inside = |name: &str| folder.join(name).display().to_string();
    std::fs::create_dir(inside("folder.exr")).expect("made");
    for (output, png, fault) in [
        ("nowhere/out.exr", None, "nowhere/out.exr: the folder of the output does not exist; make it first"),
        ("out.png", None, "out.png: the output is an OpenEXR file; end the file's name in .exr"),
        ("out", None, "out: the output is an OpenEXR file; end the file's name in .exr"),
        ("folder.exr", None, "folder.exr: the output is a folder; choose another name"),
        (
            "out.exr",
            Some("out.bmp"),
            "out.bmp: a developed picture is a PNG, a TIFF or a JPEG; end the file's name in .png",
        ),
        ("out.exr", Some("nowhere/out.png"), "nowhere/out.png: the folder of the output does not exist"),
    ] {
        // Longer than a fault may take to be reported.
        let mut arguments = vec!["render".to_owned(), "reference/cornell/scene.json".to_owned()];
        arguments.extend(["--time".to_owned(), "3".to_owned(), "-o".to_owned(), inside(output)]);
        arguments.extend(png.into_iter().flat_map(|png| ["--png".to_owned(), inside(png)]));
        let message = fail_in_one_line(&arguments);
        assert!(message.starts_with(&format!("error: {}/{fault}", folder.display())), "{message}");
    }
    let left: Vec<_> = std::fs::read_dir(&folder).expect("readable").collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

/// A rendered file: its samples by channel, as bits, and its attributes.
struct Picture {
    channels: BTreeMap<String, Vec<u32>>,
    layer: exr::prelude::LayerAttributes,
    image: exr::prelude::ImageAttributes,
}

impl Picture {
    fn read(file: &Path) -> Self {
        let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
        let image =
            reader.all_channels().first_valid_layer().all_attributes().from_file(file).expect("an EXR");
        let channels = image.layer_data.channel_data.list.iter().map(|channel| {
            let FlatSamples::F32(samples) = &channel.sample_data else {
                panic!("{} has not 32 bits", channel.name)
            };
            (channel.name.to_string(), samples.iter().map(|v| v.to_bits()).collect())
        });
        Self {
            channels: channels.collect(),
            layer: image.layer_data.attributes.clone(),
            image: image.attributes.clone(),
        }
    }

    fn names(&self) -> Vec<&str> {
        self.channels.keys().map(String::as_str).collect()
    }

    /// The facts that stand in the file as JSON.
    fn facts(&self) -> Value {
        let exr::prelude::AttributeValue::Text(facts) = self.other("etalon") else { panic!("no text") };
        serde_json::from_str(&facts.to_string()).expect("the facts are JSON")
    }

    fn other(&self, name: &str) -> &exr::prelude::AttributeValue {
        self.layer.other.get(&exr::prelude::Text::from(name)).expect(name)
    }
}

/// Renders a scene into `folder` and reads the file back.
fn render(scene: &Path, folder: &Path, options: &str) -> Picture {
    let output = folder.join(format!("{}.exr", options.replace(' ', "")));
    let fixed = ["render".as_ref(), scene.as_os_str(), "-o".as_ref(), output.as_os_str()];
    succeed(fixed.into_iter().chain(options.split(' ').map(str::as_ref)));
    Picture::read(&output)
}

/// Whether the seed alone decides every bit of a picture.
fn seed_decides(scene: &Path, folder: &Path) {
    for integrator in ["path", "bdpt"] {
        seed_decides_with(scene, folder, integrator);
    }
}

fn seed_decides_with(scene: &Path, folder: &Path, integrator: &str) {
    let common = format!("--resolution 24x24 --spp 6 --integrator {integrator}");
    let one = render(scene, folder, &format!("{common} --threads 1 --seed 7"));
    let two = render(scene, folder, &format!("{common} --threads 2 --seed 7"));
    let other = render(scene, folder, &format!("{common} --threads 2 --seed 8"));
    assert_eq!(one.names(), two.names());
    for (name, samples) in &one.channels {
        assert_eq!(samples.len(), 24 * 24);
        let differing = samples.iter().zip(&two.channels[name]).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{name} of {} depends on the number of threads", scene.display());
        assert_ne!(samples, &other.channels[name], "{name} of {} ignores the seed", scene.display());
    }
}

#[test]
fn any_number_of_threads_renders_the_same_bits() {
    let folder = folder("threads");
    for case in ["cornell", "schoedl-2007"] {
        seed_decides(&root().join("reference").join(case).join("scene.json"), &folder);
    }
    seed_decides_with(&root().join("reference/cornell/scene.json"), &folder, "light");
}

/// A point lamp, a mirror and a desk before a pinhole.
fn lamp_in_a_mirror(folder: &Path) -> PathBuf {
    let scene = serde_json::json!({
        "name": "mirror", "length_unit": "m",
        "materials": { "mirror": { "mirror": { "reflectance": 0.9 } }, "desk": { "lambertian": { "reflectance": 0.5 } } },
        "objects": [
            { "shape": { "disk": { "center": [0, 0, 1], "normal": [0, 0, -1], "radius": 1 } }, "material": "mirror" },
            { "shape": { "disk": { "center": [0, -1, 0], "normal": [0, 1, 0], "radius": 3 } }, "material": "desk" }
        ],
        "lights": [{ "point": { "position": [3, 0.5, -3],
            "emission": { "spectrum": "d65", "level": { "flux_lm": 500 } } } }],
        "camera": { "position": [0, 0, -2], "look_at": [0, -0.5, 0], "up": [0, 1, 0], "focal_length_mm": 30,
            "sensor_mm": [24, 24], "resolution": [8, 8], "f_stop": 2, "shutter_s": 0.01, "iso": 100 }
    });
    let file = folder.join("mirror.json");
    std::fs::write(&file, scene.to_string()).expect("written");
    file
}

#[test]
fn light_that_cannot_be_found_is_named_and_strict_refuses_it() {
    let folder = folder("strict");
    let scene = lamp_in_a_mirror(&folder);
    let output = folder.join("out.exr");
    for (integrator, words, remedy) in [
        ("path", ["(L S+ E)", "(L S+ D E)", "(L S+ (D S+)+ E)"].as_slice(), "bdpt"),
        ("light", &["(L S+ E)", "(L D S+ E)", "(L S+ (D S+)+ E)"], "bdpt"),
        ("bdpt", &["(L S+ E)", "(L S+ (D S+)+ E)"], "focus_distance"),
    ] {
        let run = |strict: &[&str]| {
            let fixed = ["render".as_ref(), scene.as_os_str(), "-o".as_ref(), output.as_os_str()];
            let options = ["--spp", "1", "--integrator", integrator];
            etalon(fixed.into_iter().chain(options.iter().chain(strict).map(|option| option.as_ref())))
        };
        let strict = run(&["--strict"]);
        assert_eq!(strict.status.code(), Some(3), "{integrator}");
        assert!(!output.exists(), "nothing is rendered");
        let lenient = run(&[]);
        assert_eq!(lenient.status.code(), Some(0), "{integrator}");
        for message in [text(&strict.stderr), text(&lenient.stderr)] {
            assert_eq!(message.matches("(L ").count(), words.len(), "{message}");
            assert!(words.iter().all(|word| message.contains(word)), "{message}");
            assert!(message.contains(remedy) && message.lines().count() == 1, "{message}");
        }
        let facts = Picture::read(&output).facts();
        assert_eq!(facts["missing"].as_array().map(Vec::len), Some(words.len()), "{facts}");
        std::fs::remove_file(&output).expect("it was written");
    }
    // With a lens, light finds it by itself.
    let lens = std::fs::read_to_string(&scene)
        .expect("readable")
        .replace("\"f_stop\"", "\"focus_distance\":2,\"f_stop\"");
    std::fs::write(&scene, lens).expect("written");
    render(&scene, &folder, "--spp 1 --integrator bdpt --strict");
}

/// A lamp in a closed box, and a camera outside.
fn lamp_in_a_box(folder: &Path, reflectance: f64) -> PathBuf {
    let scene = serde_json::json!({
        "name": "box", "length_unit": "m",
        "materials": { "card": { "lambertian": { "reflectance": reflectance } } },
        "objects": [
            { "shape": { "box": { "min": [-1, -1, 0], "max": [1, 1, 2] } }, "material": "card" },
            { "shape": { "disk": { "center": [0, -1.5, 0], "normal": [0, 1, 0], "radius": 3 } }, "material": "card" }
        ],
        "lights": [{ "point": { "position": [0, 0, 1],
            "emission": { "spectrum": "d65", "level": { "flux_lm": 500 } } } }],
        "camera": { "position": [0, 0, -2], "look_at": [0, 0, 0], "up": [0, 1, 0], "focal_length_mm": 30,
            "sensor_mm": [24, 24], "resolution": [8, 8], "f_stop": 2, "shutter_s": 0.01, "iso": 100 }
    });
    let file = folder.join("box.json");
    std::fs::write(&file, scene.to_string()).expect("written");
    file
}

/// The report of a run with chains: the level with its interval, and every mutation.
#[test]
fn chains_report_on_themselves() {
    let folder = folder("chains");
    let scene = root().join("reference/schoedl-2007-glass-bulb/scene.json");
    let report = folder.join("report.json");
    let options = format!("--spp 32 --resolution 32x32 --integrator mlt --report {}", report.display());
    let output = folder.join("out.exr");
    let fixed = ["render".as_ref(), scene.as_os_str(), "-o".as_ref(), output.as_os_str()];
    let printed = succeed(fixed.into_iter().chain(options.split(' ').map(AsRef::as_ref)));
    let facts: Value =
        serde_json::from_str(&std::fs::read_to_string(&report).expect("written")).expect("JSON");
    let told = &facts["metropolis"]["report"];
    assert_eq!(told, &Picture::read(&output).facts()["metropolis"]["report"], "the EXR says the same");
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{told:#}"));
    let (b, ci) = (number(&told["normalisation"]), &told["normalisation_ci95"]);
    assert!(number(&ci[0]) < b && b < number(&ci[1]) && b > 0.0, "{told:#}");
    assert!(number(&told["chains"]) >= 16.0 && number(&told["scale_reduction"]) > 0.9, "{told:#}");
    assert!(number(&told["longest_rejection"]) >= 1.0, "{told:#}");
    let rows = told["mutation_table"].as_array().expect("rows");
    assert_eq!(rows.len(), 8);
    for row in rows {
        let name = row["mutation"].as_str().expect("a name");
        assert!(printed.contains(name) && number(&row["accepted"]) > 0.0, "{name}: {row}");
    }
    let contribution: f64 = rows.iter().map(|row| number(&row["contribution"])).sum();
    assert!((contribution - 1.0).abs() < 1e-9, "{contribution}");
}

/// A render that ends at an error or a time has two halves, each ended by the other one, and
/// states an error however short it was.
#[test]
fn a_render_says_what_ended_it() {
    let folder = folder("stopping");
    let scene = root().join("reference/cornell/scene.json");
    for integrator in ["path", "light", "bdpt", "mlt"] {
        for (rule, by, fewest) in [
            ("--error 25%", "error", 64),
            ("--time 0.001", "time", 2),
            ("--error 0.1% --spp 9", "samples", 5),
        ] {
            let options = format!("{rule} --resolution 8x6 --integrator {integrator}");
            let facts = render(&scene, &folder, &options).facts();
            let ends = facts["stopping"]["ends"].as_array().expect("a list");
            assert_eq!(ends.len(), 2, "{options}: {ends:?}");
            let samples = ends.iter().map(|end| {
                assert_eq!(end["by"], by, "{options}");
                end["samples_per_pixel"].as_u64().expect("a count")
            });
            let samples: Vec<u64> = samples.collect();
            assert!(samples.iter().all(|count| *count >= fewest), "{options}: {samples:?}");
            assert_eq!(facts["samples_per_pixel"], samples.iter().sum::<u64>(), "{options}");
            assert!(facts["relative_error"].as_f64().is_some_and(|error| error > 0.0), "{options}: {facts}");
        }
        let facts =
            render(&scene, &folder, &format!("--spp 8 --resolution 8x6 --integrator {integrator}")).facts();
        let told = serde_json::json!([{ "samples_per_pixel": 8, "by": "samples" }]);
        assert_eq!(facts["stopping"]["ends"], told);
        assert_eq!(facts["parts"], 1);
    }
}

/// What is learned before the chains set out fits into the time as well.
#[test]
fn chains_keep_to_the_time() {
    let folder = folder("chains-time");
    let scene = root().join("reference/schoedl-2007-glass-bulb/scene.json");
    let started = Instant::now();
    let picture = render(&scene, &folder, "--time 2 --resolution 32x32 --integrator mlt");
    // Loading, and the last block, come on top.
    assert!(started.elapsed() < Duration::from_secs(6), "{:?}", started.elapsed());
    assert!(picture.facts()["samples_per_pixel"].as_u64() > Some(20), "{}", picture.facts());
}

#[test]
fn chains_make_pictures_only() {
    let folder = folder("chains-only");
    let scene = lamp_in_a_box(&folder, 0.5);
    let scene = scene.to_str().expect("UTF-8");
    let output = folder.join("out.exr");
    let shown = ["--integrator", "mlt", "--strategies", "shown"];
    let words = ["render", scene, "-o", output.to_str().expect("UTF-8")];
    let message = fail_in_one_line(words.into_iter().chain(shown));
    assert!(message.contains("--integrator bdpt"), "{message}");
}

/// The pictures of all strategies add up to the picture, paths beyond the longest shown aside.
#[test]
fn strategies_are_shown_one_by_one_and_add_up() {
    let folder = folder("strategies");
    let scene = root().join("reference/cornell/scene.json");
    let shown = folder.join("shown");
    let options = format!("--spp 16 --resolution 8x8 --integrator bdpt --strategies {}", shown.display());
    let output = folder.join("all.exr");
    let fixed = ["render".as_ref(), scene.as_os_str(), "-o".as_ref(), output.as_os_str()];
    succeed(fixed.into_iter().chain(options.split(' ').map(str::as_ref)));
    let mean = |picture: &Picture| {
        let samples = &picture.channels["Y"];
        samples.iter().map(|bits| f64::from(f32::from_bits(*bits))).sum::<f64>() / samples.len() as f64
    };
    let (mut sum, mut files) = (0.0, 0);
    for entry in std::fs::read_dir(&shown).expect("a folder") {
        let file = entry.expect("a file").path();
        if file.to_string_lossy().ends_with("-weighted.exr") {
            sum += mean(&Picture::read(&file));
            files += 1;
        }
    }
    // (0, 2) to (0, 7), (1, 1) to (1, 6), (2, 1) to (2, 5), and so on: none meets a pinhole. Those
    // that a render leaves to others are shown as well.
    assert_eq!(files, 6 + 6 + 5 + 4 + 3 + 2 + 1);
    let whole = mean(&Picture::read(&output));
    assert!(sum > 0.9 * whole && sum < 1.1 * whole, "{sum} of {whole}");
    assert!(shown.join("strategies.png").is_file());
    let taken = folder.join("taken");
    std::fs::write(&taken, "").expect("written");
    let message = fail_in_one_line(
        fixed_with(&scene, &output).into_iter().chain(["--strategies".into(), taken.into_os_string()]),
    );
    assert!(message.contains("make this folder"), "{message}");
}

fn fixed_with(scene: &Path, output: &Path) -> Vec<std::ffi::OsString> {
    vec!["render".into(), scene.into(), "-o".into(), output.into()]
}

#[test]
fn any_number_of_threads_renders_the_same_bits_with_dispersion() {
    let folder = folder("threads-dispersion");
    let plain = std::fs::read_to_string(root().join("reference/schoedl-2007/scene.json")).expect("readable");
    let dispersive = plain.replace("{\"index\": 1.5}", "{\"index\": \"n-sf11\"}");
    assert_ne!(plain, dispersive, "the glass has been described otherwise");
    let scene = folder.join("scene.json");
    std::fs::write(&scene, dispersive).expect("written");
    seed_decides(&scene, &folder);
}

#[test]
fn a_picture_says_what_it_is() {
    use exr::prelude::{AttributeValue, Text, attribute::Chromaticities};
    let folder = folder("facts");
    let scene = root().join("tests/files/sound.json");
    let picture = render(&scene, &folder, "--resolution 12x8 --spp 4 --seed 3");
    assert_eq!(picture.names(), ["X", "Y", "Z", "stderr.X", "stderr.Y", "stderr.Z"]);

    let facts = picture.facts();
    assert_eq!(facts["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(facts["scene"], "sound");
    assert_eq!(facts["seed"], 3);
    assert_eq!(facts["samples_per_pixel"], 4);
    assert_eq!(facts["integrator"], "path");
    assert_eq!(facts["non_finite_samples"], 0);
    let hash = facts["scene_hash"].as_str().expect("text");
    assert!(hash.len() == 16 && hash.bytes().all(|b| b.is_ascii_hexdigit()), "{hash}");
    assert!(succeed(["check", "tests/files/sound.json"]).contains(hash));
    let camera = &facts["camera"];
    for (key, value) in [("iso", 100.0), ("shutter_s", 0.01), ("f_stop", 8.0), ("focal_length_mm", 50.0)] {
        assert_eq!(camera[key], value, "{key}");
    }
    // EV100 = log2(N^2 / t) at ISO 100; saturation at 78 N^2 / (q t ISO), ISO 12232.
    for (key, truth) in [
        ("ev100", (64.0f64 / 0.01).log2()),
        ("saturation_luminance_cd_m2", 78.0 * 64.0 / (0.65 * 0.01 * 100.0)),
    ] {
        let value = camera[key].as_f64().expect("a number");
        assert!((value / truth - 1.0).abs() < 1e-12, "{key}: {value} against {truth}");
    }

    let layer = &picture.layer;
    assert_eq!(layer.exposure, Some(0.01));
    assert_eq!(layer.aperture, Some(8.0));
    assert_eq!(layer.iso_speed, Some(100.0));
    assert_eq!(layer.white_luminance, Some(1.0));
    assert_eq!(picture.other("focalLength"), &AttributeValue::F32(50.0));
    assert_eq!(layer.software_name, Some(Text::from(concat!("etalon ", env!("CARGO_PKG_VERSION")))));
    let Chromaticities { red, green, blue, white } =
        picture.image.chromaticities.expect("X, Y, Z are primaries");
    let xy = [red, green, blue, white].map(|c| [c.x(), c.y()]);
    assert_eq!(xy, [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]]);
}

#[test]
fn further_channels_are_added_when_asked_for() {
    let folder = folder("channels");
    let scene = root().join("tests/files/sound.json");
    let picture = render(&scene, &folder, "--resolution 12x8 --spp 64 --linear-srgb --spectral-layers 8");
    let mut expected: Vec<String> =
        ["X", "Y", "Z", "stderr.X", "stderr.Y", "stderr.Z", "R", "G", "B"].map(str::to_owned).to_vec();
    // Middles of eight equal bands from 360 to 830 nm.
    let middles = (0..8).map(|band| 360.0 + 470.0 / 8.0 * (f64::from(band) + 0.5));
    expected.extend(middles.map(|nm| format!("S0.{nm:.6}nm").replace('.', ",").replacen(',', ".", 1)));
    expected.sort();
    assert_eq!(picture.names(), expected);
    // The names R, G, B mean what readers expect only with sRGB's primaries.
    let red = picture.image.chromaticities.expect("sRGB's primaries").red;
    assert_eq!([red.x(), red.y()], [0.64, 0.33]);
    let at = |name: &str, pixel: usize| f64::from(f32::from_bits(picture.channels[name][pixel]));
    let brightest = (0..96).max_by(|a, b| at("Y", *a).total_cmp(&at("Y", *b))).expect("pixels");
    assert!(at("Y", brightest) > 0.0);
    // Y of sRGB's primaries, IEC 61966-2-1.
    let luminance = 0.2126 * at("R", brightest) + 0.7152 * at("G", brightest) + 0.0722 * at("B", brightest);
    assert!(
        (luminance / at("Y", brightest) - 1.0).abs() < 1e-3,
        "{luminance} against {}",
        at("Y", brightest)
    );
}

#[test]
fn a_developed_picture_is_written_beside_the_absolute_one() {
    let folder = folder("developed");
    for name in ["out.png", "out.tiff"] {
        let (exr, png) = (folder.join("out.exr"), folder.join(name));
        let arguments =
            ["render".as_ref(), "tests/files/sound.json".as_ref(), "-o".as_ref(), exr.as_os_str()];
        let options = ["--png".as_ref(), png.as_os_str(), "--spp".as_ref(), "2".as_ref()];
        succeed(arguments.into_iter().chain(options));
        let picture = image::open(&png).expect("a picture");
        assert_eq!([picture.width(), picture.height()], [36, 24]);
    }
    assert_eq!(std::fs::read_dir(&folder).expect("readable").count(), 3, "nothing temporary is left");
}

#[test]
fn rendering_off_a_terminal_is_silent_but_for_a_line_and_the_conditions() {
    let folder = folder("silent");
    let output = folder.join("out.exr");
    let arguments =
        ["render".as_ref(), "reference/cornell/scene.json".as_ref(), "-o".as_ref(), output.as_os_str()];
    let options = ["--resolution", "32x32", "--spp", "8"].map(str::as_ref);
    let said = succeed(arguments.into_iter().chain(options));
    let [picked, line, conditions] = said.lines().collect::<Vec<_>>()[..] else { panic!("{said}") };
    assert!(picked.starts_with("auto: path: "), "{said}");
    assert!(line.contains("8 samples per pixel"), "{said}");
    assert_eq!(conditions, "conditions 1 extreme: dark_range; `etalon check --explain` tells more");
}

#[test]
fn extreme_conditions_are_counted_and_explained_on_request() {
    let scene = "reference/pool/scene.json";
    let said = succeed(["check", scene]);
    assert!(
        said.ends_with("conditions 2 extreme: small_emitter, beyond_half_float; --explain tells more\n"),
        "{said}"
    );
    let explained = succeed(["check", "--explain", scene]);
    for part in [
        "extreme    small_emitter (sun)",
        "  noise       path: ",
        "  remedy      --integrator mlt, ",
        "not found  hidden_lamps, ",
    ] {
        assert!(explained.contains(part), "{explained}");
    }
    let plain = succeed(["check", "--explain", "reference/stanford/scene.json"]);
    assert!(
        plain.contains("conditions none extreme\n") && plain.contains("not found  small_emitter, "),
        "{plain}"
    );
}

/// Conditions of one name are counted, and every label stands apart from what it labels.
#[test]
fn conditions_of_one_name_are_counted_and_labels_stand_apart() {
    let folder = folder("conditions");
    let rough =
        |alpha: f64| serde_json::json!({ "conductor": { "metal": "silver", "roughness_alpha": alpha } });
    let ball = |material: &str, x: f64| serde_json::json!({ "material": material, "shape": { "sphere": { "center": [x, 0, 1], "radius": 0.2 } } });
    let scene = serde_json::json!({
        "name": "room", "length_unit": "m",
        "materials": { "wall": { "lambertian": { "reflectance": 0.99999 } }, "a": rough(0.3), "b": rough(0.5) },
        "objects": [{ "material": "wall", "shape": { "sphere": { "center": [0, 0, 0], "radius": 20 } } }, ball("a", 0.5), ball("b", -0.5)],
        "lights": [{ "point": { "position": [0, 1, 0], "emission": { "spectrum": "d65", "level": { "flux_lm": 500 } } } }],
        "meters": [{ "illuminance": { "name": "wall", "position": [0, 0, -19.9], "normal": [0, 0, 1] } }],
    });
    let file = folder.join("room.json");
    std::fs::write(&file, scene.to_string()).expect("written");
    let said = succeed(["check".as_ref(), file.as_os_str(), "--explain".as_ref()]);
    assert!(said.contains("conditions 3 extreme: facet_loss (2), high_albedo\n"), "{said}");
    assert!(said.contains("\n  sensitivity the level goes inversely with the "), "{said}");
    assert!(said.contains("mean_loss_per_reflection "), "{said}");
    // Its few losses may go unseen by a render, which then cuts paths off.
    assert!(said.contains("cuts paths off after 250") && !said.contains("none is cut off"), "{said}");
}

#[test]
fn every_reference_scene_is_explained_in_numbers() {
    for scene in reference_scenes() {
        let said = succeed(["check".as_ref(), scene.as_os_str()]);
        let line = |start: &str| {
            said.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{said}"))
        };
        let number_before = |line: &str, unit: &str| -> f64 {
            let before = line.split(unit).next().unwrap_or_default();
            before.rsplit(' ').next().and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{line}"))
        };
        let file = json(&scene);
        let lamp = file["objects"].as_array().expect("objects").iter().find_map(|o| o.get("emission"));
        let level = &lamp.expect("a lamp")["level"];
        let truth = match (&level["flux_lm"], &level["electrical_power"]) {
            (Value::Number(lumens), _) => lumens.as_f64(),
            (_, Value::Object(lamp)) => lamp["power_w"]
                .as_f64()
                .zip(lamp["efficacy_lm_per_w"].as_f64())
                .map(|(watts, efficacy)| watts * efficacy),
            _ => None,
        };
        let lumens = number_before(line("light"), " lm,");
        assert!(lumens > 0.0, "{said}");
        if let Some(truth) = truth {
            assert!((lumens / truth - 1.0).abs() < 1e-6, "{}: {lumens} lm, not {truth}", scene.display());
        }
        let kelvin = number_before(line("light").split_once("CCT").expect("a CCT").1, " K");
        assert!((1000.0..25_000.0).contains(&kelvin), "{said}");

        let camera = |key: &str| file["camera"][key].as_f64().expect("a number");
        let truth = (camera("f_stop").powi(2) / camera("shutter_s") * 100.0 / camera("iso")).log2();
        let ev100 = number_before(line("exposure").split_once("EV100").expect("EV100").1, ",");
        assert!((ev100 - truth).abs() < 6e-4, "{}: EV100 {ev100}, not {truth}", scene.display());
    }
}

#[test]
fn measurements_come_as_json() {
    // One candela in every direction from two metres: a quarter of a lux.
    let scene = r#"{
        "name": "point", "length_unit": "m",
        "lights": [{"point": {"position": [0, 0, 2], "emission": {"spectrum": "d65", "level": {"intensity_cd": 1}}}}],
        "meters": [{"illuminance": {"name": "desk", "position": [0, 0, 0], "normal": [0, 0, 1]}}]
    }"#;
    let file = folder("measure").join("scene.json");
    std::fs::write(&file, scene).expect("written");
    let options = ["--json", "--samples", "4096", "--seed", "5"].map(str::as_ref);
    let said = succeed(["measure".as_ref(), file.as_os_str()].into_iter().chain(options));
    let report: Value = serde_json::from_str(&said).expect("JSON");
    assert_eq!((&report["samples"], &report["seed"]), (&4096.into(), &5.into()));
    let reading = &report["meters"][0];
    assert_eq!(
        (&reading["name"], &reading["kind"], &reading["unit"]),
        (&"desk".into(), &"illuminance".into(), &"lx".into())
    );
    let number = |key: &str| reading[key].as_f64().expect("a number");
    let (value, half_width) = (number("value"), number("half_width_95"));
    // A half width of 95 % is two standard errors; five of them at most.
    assert!((value - 0.25).abs() < 2.5 * half_width + 1e-6, "{value} +- {half_width} lx, not 0.25");
    assert!(half_width < 0.02, "{half_width}");
}

#[test]
fn spectra_of_every_kind_are_listed() {
    let kinds: BTreeSet<String> = std::fs::read_dir(root().join("spectra"))
        .expect("the spectra are there")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| {
            let mut inside = std::fs::read_dir(path).into_iter().flatten().flatten();
            inside.any(|file| file.path().extension().is_some_and(|ending| ending == "csv"))
        })
        .map(|path| path.file_name().expect("a name").to_string_lossy().into_owned())
        .collect();
    let list = succeed(["spectra"]);
    let listed: BTreeSet<String> =
        list.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    assert_eq!(listed, kinds);
    for name in ["d65", "cornell-white", "gold", "n-bk7", "cornell-lamp", "sodium-low-pressure"] {
        assert!(list.lines().any(|line| line.split_whitespace().nth(1) == Some(name)), "{name}");
    }
}

#[test]
fn a_glass_is_described_by_its_index_and_abbe_number() {
    let said = succeed(["spectra", "n-bk7"]);
    let line = said.lines().find(|line| line.starts_with("index")).expect("an index");
    let numbers: Vec<f64> = line
        .split(|c: char| !(c.is_ascii_digit() || c == '.'))
        .filter_map(|word| word.parse().ok())
        .collect();
    // Schott's data sheet: nd 1.51680, vd 64.17.
    assert!((numbers[0] - 1.5168).abs() < 5e-6 && (numbers[1] - 64.17).abs() < 5e-3, "{line}");
}

#[test]
fn an_unknown_spectrum_is_refused_with_a_suggestion() {
    let near = fail_in_one_line(["spectra", "n-bk8"]);
    assert_eq!(near, "error: unknown spectrum \"n-bk8\"; did you mean \"n-bk7\"?");
    let far = fail_in_one_line(["spectra", "nosuch"]);
    assert!(far.contains("unknown spectrum \"nosuch\"; ") && far.ends_with(" among them"), "{far}");
}

/// Why a value does not follow a schema, with its pointer; `None` where it does. Knows the
/// keywords that the scene's schema uses, and refuses others.
fn breach(schema: &Value, whole: &Value, value: &Value, pointer: &str) -> Option<String> {
    let wrong = |why: &str| Some(format!("{pointer}: {why}"));
    for (keyword, rule) in schema.as_object().expect("a schema is an object") {
        let inside = |part: &Value, value: &Value, name: &str| {
            breach(part, whole, value, &format!("{pointer}/{name}"))
        };
        let list = || rule.as_array().expect("a list of alternatives").iter();
        let found = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" | "format" => None,
            "$ref" => {
                let target =
                    rule.as_str().and_then(|link| whole.pointer(link.strip_prefix('#')?)).expect("a target");
                breach(target, whole, value, pointer)
            }
            "type" if rule.is_array() => {
                let fits = list().any(|kind| is_of_type(value, kind));
                if fits { None } else { wrong(&format!("not of type {rule}")) }
            }
            "type" => {
                if is_of_type(value, rule) {
                    None
                } else {
                    wrong(&format!("not of type {rule}"))
                }
            }
            "const" => {
                if value == rule {
                    None
                } else {
                    wrong(&format!("not {rule}"))
                }
            }
            "enum" => {
                if list().any(|one| one == value) {
                    None
                } else {
                    wrong(&format!("none of {rule}"))
                }
            }
            "minimum" => match (value.as_f64(), rule.as_f64()) {
                (Some(value), Some(least)) if value < least => wrong("too small"),
                _ => None,
            },
            "anyOf" | "oneOf" => {
                let fitting = list().filter(|one| breach(one, whole, value, pointer).is_none()).count();
                let fits = if keyword == "oneOf" { fitting == 1 } else { fitting > 0 };
                if fits { None } else { wrong(&format!("{fitting} alternatives fit")) }
            }
            "minItems" => value
                .as_array()
                .filter(|l| (l.len() as u64) < rule.as_u64().expect("a count"))
                .and(wrong("too short")),
            "maxItems" => value
                .as_array()
                .filter(|l| l.len() as u64 > rule.as_u64().expect("a count"))
                .and(wrong("too long")),
            "items" => {
                let mut items = value.as_array().into_iter().flatten().enumerate();
                items.find_map(|(index, item)| inside(rule, item, &index.to_string()))
            }
            "required" => value
                .as_object()
                .and_then(|object| list().find(|key| !object.contains_key(key.as_str().expect("a key"))))
                .and_then(|key| wrong(&format!("{key} is missing"))),
            "properties" => {
                let mut entries = value.as_object().into_iter().flatten();
                entries.find_map(|(key, value)| inside(rule.get(key)?, value, key))
            }
            "additionalProperties" => {
                let known = schema.get("properties").and_then(Value::as_object);
                let mut others = value.as_object().into_iter().flatten();
                others.find_map(|(key, value)| match rule {
                    _ if known.is_some_and(|known| known.contains_key(key)) => None,
                    Value::Bool(allowed) => {
                        if *allowed {
                            None
                        } else {
                            wrong(&format!("{key} is unknown"))
                        }
                    }
                    part => inside(part, value, key),
                })
            }
            other => panic!("the schema uses \"{other}\", which this test does not know"),
        };
        if found.is_some() {
            return found;
        }
    }
    None
}

fn is_of_type(value: &Value, kind: &Value) -> bool {
    match kind.as_str().expect("a type") {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("unknown type \"{other}\""),
    }
}

#[test]
fn the_schema_fits_every_reference_scene() {
    let schema: Value = serde_json::from_str(&succeed(["schema"])).expect("JSON");
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    for scene in reference_scenes() {
        assert_eq!(breach(&schema, &schema, &json(&scene), ""), None, "{}", scene.display());
    }
}

#[test]
fn the_schema_refuses_what_the_program_refuses_by_form() {
    let schema: Value = serde_json::from_str(&succeed(["schema"])).expect("JSON");
    let files = root().join("tests/files");
    assert_eq!(breach(&schema, &schema, &json(&files.join("sound.json")), ""), None);
    for (file, pointer) in [
        ("key-unknown", "/camera"),
        ("key-unknown-at-the-root", ""),
        ("key-unknown-in-a-shape", "/objects/0/shape"),
        ("key-missing", "/camera"),
        ("key-missing-at-the-root", ""),
        ("variant-unknown", "/materials/white"),
        ("variant-unknown-unit", "/length_unit"),
        ("variant-two-in-one", "/objects/0/shape"),
        ("variant-is-a-number", "/objects/0/shape"),
        ("type-wrong", "/camera"),
        ("type-fraction-of-a-pixel", "/camera"),
        ("type-null", "/materials/white"),
        ("list-too-short", "/camera"),
        ("list-too-long", "/camera"),
        ("level-two-at-once", "/objects/0/emission"),
        ("band-misspelt", "/objects/0/emission"),
    ] {
        let found = breach(&schema, &schema, &json(&files.join(format!("{file}.json"))), "");
        let found = found.unwrap_or_else(|| panic!("the schema allows {file}.json"));
        assert!(found.starts_with(&format!("{pointer}: ")), "{file}: {found}");
    }
}

/// A picture of one pixel in which no sample is finite, so that every sample has its name.
struct Overflowing {
    scene: PathBuf,
    report: PathBuf,
    facts: Value,
}

impl Overflowing {
    fn render(test: &str, options: &str) -> Self {
        let folder = folder(test);
        let [scene, report, picture] = ["scene.json", "report.json", "out.exr"].map(|name| folder.join(name));
        let text = serde_json::json!({
            "name": "overflow", "length_unit": "m",
            "materials": { "black": { "lambertian": { "reflectance": 0 } } },
            "objects": [{ "material": "black", "shape": { "sphere": { "center": [0, 0, 0], "radius": 2 } },
                "emission": { "spectrum": 1, "level": { "spectral_radiance_factor": 1e34 }, "two_sided": true } }],
            "meters": [{ "luminance": { "name": "gauge", "position": [0, 0, 0], "direction": [0, 0, 1] } }],
            "camera": { "position": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "focal_length_mm": 36,
                "sensor_mm": [24, 24], "resolution": [1, 1], "iso": 100, "shutter_s": 0.01, "f_stop": 1 },
        });
        std::fs::write(&scene, text.to_string()).expect("written");
        let paths = ["render".as_ref(), scene.as_os_str(), "-o".as_ref(), picture.as_os_str()];
        let output = etalon(
            paths
                .into_iter()
                .chain(["--report".as_ref(), report.as_os_str()])
                .chain(options.split(' ').map(str::as_ref)),
        );
        assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
        let facts = json(&report);
        Self { scene, report, facts }
    }

    /// Arguments that replay what options say, from the report.
    fn replay(&self, options: &str) -> Vec<std::ffi::OsString> {
        let fixed = ["replay".as_ref(), self.scene.as_os_str(), "--from".as_ref(), self.report.as_os_str()];
        fixed.into_iter().chain(options.split_whitespace().map(str::as_ref)).map(Into::into).collect()
    }

    /// Whether each of so many samples of a half, found by its block and index, is that of its
    /// name.
    fn finds(&self, half: &str, first: usize, count: usize) {
        let names = self.facts["non_finite"].as_array().expect("a list");
        for (number, name) in names.iter().enumerate().skip(first).take(count) {
            let name = &name["pixel"];
            let place = format!("--pixel 0,0 {half} --block {} --index {}", name["block"], name["index"]);
            let found = succeed(self.replay(&place));
            assert_eq!(found, succeed(self.replay(&format!("--sample {number}"))), "{place}");
            assert!(found.contains(&format!("seed {}, block", name["seed"])), "{found}");
            assert!(!found.contains("note "), "{found}");
        }
    }
}

fn text_of(output: &Output) -> &str {
    text(&output.stderr)
}

/// 50 samples make blocks of 12, 12, 12, 12 and 2.
#[test]
fn replay_finds_the_samples_of_a_render_and_no_others() {
    let render = Overflowing::render("replay", "--spp 50 --seed 3");
    assert_eq!(render.facts["non_finite"].as_array().map(Vec::len), Some(50));
    render.finds("", 0, 50);
    for (options, what, remedy) in [
        ("--pixel 0,0 --block 4 --index 2", "a block of 2 samples has no sample 2", "counted from 0"),
        ("--pixel 0,0 --block 5", "there is no block 5 among the 5", "counted from 0"),
        ("--pixel 0,0 --block 9999", "there is no block 9999 among the 5", "counted from 0"),
        ("--pixel 0,0 --half 1", "the picture has no halves", "leave --half out"),
        ("--meter gauge", "it is of a picture and has no readings", "--pixel X,Y"),
        ("--pixel 1,0", "pixel 1,0 lies outside of 1 x 1 pixels", "counted from 0"),
    ] {
        let line = fail_in_one_line(render.replay(options));
        assert!(line.contains(what) && line.contains(remedy), "{options}: {line}");
    }
    let other = succeed(render.replay("--pixel 0,0 --seed 4 --block-size 12 --integrator bdpt"));
    assert!(other.contains(", for its --seed, --integrator\n"), "{other}");
}

/// Each half has a seed of its own, and blocks of 1, 1, 2, 4, 8 and 4 make its 20 samples.
#[test]
fn replay_finds_the_samples_of_both_halves() {
    let render = Overflowing::render("replay-halves", "--spp 40 --error 0.1% --seed 3");
    let names = render.facts["non_finite"].as_array().expect("a list");
    assert_eq!(names.len(), 40);
    let seeds: Vec<&Value> = names.iter().map(|name| &name["pixel"]["seed"]).collect();
    let first = seeds.iter().take_while(|seed| **seed == seeds[0]).count();
    assert_eq!(first, 20, "{seeds:?}");
    render.finds("--half 0", 0, first);
    render.finds("--half 1", first, 20);
    render.finds("", 0, 1);
    for (options, what) in [
        ("--pixel 0,0 --half 1 --block 6", "there is no block 6 among the 6 of that half"),
        ("--pixel 0,0 --block 5 --index 4", "a block of 4 samples has no sample 4"),
    ] {
        let line = fail_in_one_line(render.replay(options));
        assert!(line.contains(what), "{options}: {line}");
    }
}

#[test]
fn replay_takes_what_renders_and_readings_say_and_nothing_else() {
    let folder = folder("replay-from");
    let scene = root().join("tests/files/sound.json");
    let from = folder.join("from.json");
    let hash = serde_json::json!({ "scene_hash": "0" });
    for (text, what) in [
        ("{}".to_owned(), "it has no \"scene_hash\""),
        (std::fs::read_to_string(&scene).expect("readable"), "it "),
        (hash.to_string(), "it is of another scene"),
        ("[{".to_owned(), "its facts cannot be read"),
    ] {
        std::fs::write(&from, &text).expect("written");
        let line = fail_in_one_line([
            "replay".as_ref(),
            scene.as_os_str(),
            "--from".as_ref(),
            from.as_os_str(),
            "--pixel".as_ref(),
            "0,0".as_ref(),
        ]);
        assert!(line.contains("from.json: ") && line.contains(what) && line.contains("give "), "{line}");
    }
}

/// A lamp that its own shade hides.
const SHADED: &str = r#"{ "name": "shaded", "length_unit": "m",
  "materials": { "black": { "lambertian": { "reflectance": 0 } } },
  "objects": [
    { "shape": { "sphere": { "center": [0, 0, 0], "radius": 0.5 } }, "material": "black" },
    { "shape": { "sphere": { "center": [0, 0, 0], "radius": 0.1 } }, "material": "black",
      "emission": { "spectrum": "d65", "level": { "flux_lm": 800 } } } ],
  "camera": { "position": [0, 0, -2], "look_at": [0, 0, 0], "up": [0, 1, 0], "focal_length_mm": 50, "sensor_mm": [36, 24],
    "resolution": [6, 4], "f_stop": 8, "shutter_s": 0.01, "iso": 100 } }"#;

#[test]
fn a_black_picture_under_lamps_states_no_error_and_fails_under_strict() {
    let folder = folder("shaded");
    let scene = folder.join("scene.json");
    std::fs::write(&scene, SHADED).expect("written");
    for (strict, code) in [(false, 0), (true, 3)] {
        let (out, report) = (folder.join("out.exr"), folder.join("out.json"));
        let words =
            ["render".as_ref(), scene.as_os_str(), "-o".as_ref(), out.as_os_str(), "--report".as_ref()];
        let options = ["--spp", "64", "--error", "5%"].map(AsRef::as_ref);
        let strict: &[&std::ffi::OsStr] = if strict { &["--strict".as_ref()] } else { &[] };
        let output = etalon(
            words.into_iter().chain([report.as_os_str()]).chain(options).chain(strict.iter().copied()),
        );
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert!(said.contains("the picture is black: lamps shine, and 64 samples per pixel"), "{said}");
        assert!(!String::from_utf8_lossy(&output.stdout).contains("relative error"));
        let facts = std::fs::read_to_string(&report).expect("written");
        let facts: serde_json::Value = serde_json::from_str(&facts).expect("JSON");
        assert_eq!(facts["no_light_found"], true);
        assert!(facts["relative_error"].is_null());
    }
}

#[test]
fn outputs_do_not_overwrite_one_another() {
    let folder = folder("distinct");
    let scene = folder.join("scene.json");
    std::fs::write(&scene, SHADED).expect("written");
    let place = |name: &str| folder.join(name).into_os_string();
    for (option, file, same) in [
        ("--checkpoint", "out.exr", "the checkpoint would overwrite the picture"),
        ("--checkpoint", "./out.png", "the checkpoint would overwrite the developed picture"),
        ("--checkpoint", "out.json", "the checkpoint would overwrite the report"),
    ] {
        let words =
            ["render".into(), scene.clone().into_os_string(), "-o".into(), place("out.exr"), "--png".into()];
        let more = [place("out.png"), "--report".into(), place("out.json"), option.into(), place(file)];
        let output = etalon(words.into_iter().chain(more));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(same) && said.lines().count() == 1, "{said}");
    }
}
