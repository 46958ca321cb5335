//! EXRs made by hand: of other renderers, and with facts as a render states them.

use exr::meta::attribute::Chromaticities;
use exr::prelude::*;
use std::path::{Path, PathBuf};

/// What a file has beside its channels.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// Channels by their names, in rows.
    pub channels: Vec<(&'static str, Vec<f32>)>,
    /// Attribute of this name.
    pub chromaticities: Option<Chromaticities>,
    /// Attribute of this name.
    pub white_luminance: Option<f32>,
    /// The attribute `etalon`.
    pub facts: Option<String>,
}

impl Written {
    /// Writes the file.
    pub fn write(&self, folder: &Path, name: &str, size: [usize; 2]) -> PathBuf {
        let channel = |(name, values): &(&str, Vec<f32>)| {
            AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(values.clone()))
        };
        let mut attributes = LayerAttributes { white_luminance: self.white_luminance, ..Default::default() };
        if let Some(facts) = &self.facts {
            let text = AttributeValue::Text(Text::from(facts.as_str()));
            attributes.other.insert(Text::from("etalon"), text);
        }
        let channels = AnyChannels::sort(self.channels.iter().map(channel).collect());
        let layer = Layer::new((size[0], size[1]), attributes, Encoding::FAST_LOSSLESS, channels);
        let mut image = Image::from_layer(layer);
        image.attributes.chromaticities = self.chromaticities;
        let file = folder.join(name);
        image.write().to_file(&file).expect("the folder can be written to");
        file
    }
}

/// Independent standard normal numbers.
pub struct Numbers(pub u64);

impl Numbers {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        ((etalon::sampler::mix(etalon::sampler::mix(self.0)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// The next one.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
