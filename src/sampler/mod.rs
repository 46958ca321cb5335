//! Random numbers with names.
//!
//! Every number a path needs is named by what it decides ([`Stream`]) and at which bounce,
//! not by its place in a queue: leaving one out shifts no other, and a sample's numbers
//! depend on nothing but seed, pixel, block and index.
//!
//! Within a block of samples each name is a two-dimensional Sobol sequence with Owen
//! scrambling by hashing (Burley 2020, "Practical hash-based Owen scrambling", JCGT 9(4)),
//! shuffled so that different names are independent. Blocks have independent scrambles,
//! which makes the scatter of block means an honest error estimate.

pub(crate) mod inverse;
mod sobol;

use sobol::Member;
pub use sobol::owen_sobol_2d;

/// What a random number decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// Position within the pixel.
    Pixel,
    /// Position on the lens.
    Lens,
    /// Wavelengths of the path.
    Wavelength,
    /// Which light is asked.
    LightChoice,
    /// Where on that light.
    LightPoint,
    /// Direction in which a path goes on.
    Direction,
    /// Which of several things a surface does.
    Lobe,
    /// Whether a path goes on at all.
    Roulette,
    /// Which light a subpath starts from.
    EmissionChoice,
    /// Where on that light.
    EmissionPoint,
    /// Direction in which light leaves it.
    EmissionDirection,
    /// As `Direction`, for subpaths from a light.
    LightDirection,
    /// As `Lobe`, for subpaths from a light.
    LightLobe,
    /// As `Roulette`, for subpaths from a light.
    LightRoulette,
    /// Position on the lens that light is joined to.
    Splat,
    /// Whether an obstacle is looked for between two vertices.
    Visibility,
}

/// Streams per bounce in the numbering of dimensions.
const STREAMS: u32 = 16;

/// The random numbers of one sample.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    key: u64,
    member: Member,
}

/// The random numbers of one block of samples in one pixel.
#[derive(Clone, Copy, Debug)]
pub struct BlockSampler {
    key: u64,
    index_bits: u32,
}

impl BlockSampler {
    /// The block `block` of `size` samples in pixel `pixel` of the run that `seed` names.
    pub fn new(seed: u64, pixel: u64, block: u32, size: u32) -> Self {
        let key = mix(mix(mix(seed) ^ pixel) ^ u64::from(block));
        Self { key, index_bits: size.next_power_of_two().trailing_zeros() }
    }

    /// The numbers of one sample of the block.
    pub const fn sample(&self, index: u32) -> Sampler {
        Sampler { key: self.key, member: Member::new(index, self.index_bits) }
    }
}

impl Sampler {
    /// Two numbers in [0, 1) for a decision at a bounce.
    #[inline]
    pub fn pair(&self, stream: Stream, bounce: u32) -> [f32; 2] {
        self.member.scrambled(self.key_of(stream, bounce))
    }

    /// One number in [0, 1) with 48 bits, for a choice among things of very unequal weight.
    #[inline]
    pub fn fine(&self, stream: Stream, bounce: u32) -> f64 {
        let [high, low] = self.pair(stream, bounce).map(f64::from);
        high + low / 16_777_216.0
    }

    /// One number in [0, 1) for a decision at a bounce.
    #[inline]
    pub fn single(&self, stream: Stream, bounce: u32) -> f32 {
        self.member.first_scrambled(self.key_of(stream, bounce))
    }

    #[inline]
    const fn key_of(&self, stream: Stream, bounce: u32) -> u64 {
        mix(self.key ^ (bounce as u64 * STREAMS as u64 + stream as u64))
    }
}

/// A bijection of 64 bits in which every input bit changes half of the output bits.
///
/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
#[inline]
pub const fn mix(value: u64) -> u64 {
    let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_share_numbers() {
        let sampler = BlockSampler::new(1, 2, 3, 16).sample(5);
        let mut seen = Vec::new();
        for bounce in 0..50 {
            for stream in [Stream::Pixel, Stream::Lobe, Stream::Direction, Stream::Roulette] {
                seen.extend(sampler.pair(stream, bounce).map(f32::to_bits));
            }
        }
        let count = seen.len();
        seen.sort_unstable();
        seen.dedup();
        // 400 numbers of 24 bits: 0.005 coincidences are expected.
        assert!(seen.len() + 1 >= count);
    }

    /// Numbers of different names, at the same index, are uncorrelated over many blocks.
    /// |z| < 5 for each of six pairs: false alarm rate 3e-6.
    #[test]
    fn names_are_independent() {
        const BLOCKS: u32 = 40_000;
        let names =
            [(Stream::Pixel, 0), (Stream::LightPoint, 0), (Stream::Direction, 1), (Stream::Direction, 2)];
        for (i, a) in names.iter().enumerate() {
            for b in &names[..i] {
                let mut sum = 0.0;
                for block in 0..BLOCKS {
                    let sampler = BlockSampler::new(7, 9, block, 16).sample(block % 16);
                    let centred = |n: &(Stream, u32)| f64::from(sampler.single(n.0, n.1)) - 0.5;
                    sum += centred(a) * centred(b);
                }
                let z = sum / (f64::from(BLOCKS) / 144.0).sqrt();
                assert!(z.abs() < 5.0, "{a:?} {b:?}: z = {z}");
            }
        }
    }

    /// Within a block, products of two names' numbers average out as one over its size: for
    /// independent numbers the mean square of a block's mean product is 1 / (144 * 256).
    /// The nested shuffle keeps neighbours in opposite halves, which ties samples in pairs
    /// and can at most double it; a relative standard deviation of sqrt(2 / 400) comes on top.
    #[test]
    fn names_are_independent_within_a_block() {
        const SIZE: u32 = 256;
        const BLOCKS: u32 = 400;
        let names =
            [(Stream::Pixel, 0), (Stream::LightPoint, 0), (Stream::Direction, 1), (Stream::Roulette, 2)];
        for (i, a) in names.iter().enumerate() {
            for b in &names[..i] {
                let mut sum = 0.0;
                for block in 0..BLOCKS {
                    let numbers = BlockSampler::new(11, 3, block, SIZE);
                    let product = |index| {
                        let sampler = numbers.sample(index);
                        let centred = |n: &(Stream, u32)| f64::from(sampler.single(n.0, n.1)) - 0.5;
                        centred(a) * centred(b)
                    };
                    sum += ((0..SIZE).map(product).sum::<f64>() / f64::from(SIZE)).powi(2);
                }
                let ratio = sum / f64::from(BLOCKS) * 144.0 * f64::from(SIZE);
                assert!(
                    ratio < 2.0 * (1.0 + 5.0 * (2.0 / f64::from(BLOCKS)).sqrt()),
                    "{a:?} {b:?}: ratio {ratio}"
                );
            }
        }
    }
}
