//! The first two dimensions of Sobol's sequence, Owen-scrambled and shuffled.

use super::mix;

/// A point of a scrambled and shuffled two-dimensional Sobol sequence, in [0, 1)^2.
///
/// `index` runs from 0 within a block of 2^`index_bits` points; `key` picks the scramble.
#[inline]
pub fn owen_sobol_2d(index: u32, index_bits: u32, key: u64) -> [f32; 2] {
    Member::new(index, index_bits).scrambled(key)
}

/// One of a block's points before any scramble: what all of its scrambles share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    reversed_index: u32,
    /// Bits of the indices of the block.
    mask: u32,
}

impl Member {
    #[inline]
    pub(super) const fn new(index: u32, index_bits: u32) -> Self {
        Self { reversed_index: index.reverse_bits(), mask: ((1_u64 << index_bits) - 1) as u32 }
    }

    /// Both coordinates under the scramble that a key picks.
    #[inline]
    pub(super) fn scrambled(self, key: u64) -> [f32; 2] {
        let shuffled = self.shuffled(key);
        let x = laine_karras(shuffled, key as u32);
        let y = laine_karras(second_dimension(shuffled), (key >> 32) as u32);
        // Turned round together: the first becomes the upper half.
        let both = ((u64::from(y) << 32) | u64::from(x)).reverse_bits();
        [to_unit((both >> 32) as u32), to_unit(both as u32)]
    }

    /// The first of them.
    #[inline]
    pub(super) fn first_scrambled(self, key: u64) -> f32 {
        to_unit(laine_karras(self.shuffled(key), key as u32).reverse_bits())
    }

    /// The place of the point in the sequence: shuffled within the block, so that any power-of-two
    /// prefix stays a net.
    ///
    /// The shuffle has its own key: with one of the scrambles' the leading bits would cancel.
    /// Scrambled from the highest bit down, so that neighbours end up far apart; from the lowest
    /// up, the halves of one name would fall on the halves of every other.
    #[inline]
    const fn shuffled(self, key: u64) -> u32 {
        laine_karras(self.reversed_index, (mix(key) >> 32) as u32).reverse_bits() & self.mask
    }
}

/// Radical inverse in Sobol's second dimension, with the bit next to the binary point lowest.
///
/// Its direction numbers are the rows of Pascal's triangle modulo 2: bit k stands for
/// (1 + x)^k, so the bits are the coefficients of p(1 + x) where those of `index` are those of
/// p. As (1 + x)^m = 1 + x^m for a power of two m, halves of ever smaller parts add up.
#[inline]
const fn second_dimension(index: u32) -> u32 {
    let mut bits = index;
    bits ^= bits >> 16;
    bits ^= (bits >> 8) & 0x00ff_00ff;
    bits ^= (bits >> 4) & 0x0f0f_0f0f;
    bits ^= (bits >> 2) & 0x3333_3333;
    bits ^= (bits >> 1) & 0x5555_5555;
    bits
}

/// A hash in which a bit depends on itself and lower bits alone (Laine and Karras 2011),
/// with the constants of Vegdahl 2021 for better mixing.
#[inline]
const fn laine_karras(value: u32, seed: u32) -> u32 {
    let mut x = value;
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

#[inline]
fn to_unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_dimension_adds_rows_of_pascals_triangle() {
        for index in (0..4096).chain((0..4096).map(|i| mix(i) as u32)) {
            let (mut row, mut sum) = (1_u32, 0);
            for bit in 0..32 {
                sum ^= if index >> bit & 1 == 1 { row } else { 0 };
                row ^= row << 1;
            }
            assert_eq!(second_dimension(index), sum, "{index:#x}");
        }
    }

    #[test]
    fn the_first_coordinate_is_the_same_alone() {
        for key in (0..200).map(mix) {
            for index in 0..16 {
                let member = Member::new(index, 4);
                assert_eq!(member.first_scrambled(key), member.scrambled(key)[0]);
            }
        }
    }

    /// A (0, m, 2)-net in base 2: every elementary interval of area 2^-m holds one point.
    #[test]
    fn every_block_is_a_net() {
        for bits in [2_u32, 4, 6] {
            for key in (0..200).map(mix) {
                let points: Vec<[f32; 2]> = (0..1 << bits).map(|i| owen_sobol_2d(i, bits, key)).collect();
                for columns in 0..=bits {
                    let rows = bits - columns;
                    let mut seen = vec![false; 1 << bits];
                    for [x, y] in &points {
                        let cell = |v: f32, bits: u32| (v * (1_u32 << bits) as f32) as usize;
                        let index = (cell(*x, columns) << rows) | cell(*y, rows);
                        assert!(!seen[index], "{bits} bits, key {key}: two points in one interval");
                        seen[index] = true;
                    }
                }
            }
        }
    }

    /// Over scrambles each point is uniform: chi-squared on 64 cells for one index.
    /// 63 degrees of freedom; 130 is the 1e-6 quantile.
    #[test]
    fn a_point_is_uniform_over_scrambles() {
        const KEYS: u64 = 64_000;
        let mut counts = [0_u32; 64];
        for key in 0..KEYS {
            let [x, y] = owen_sobol_2d(3, 4, mix(key));
            counts[(x * 8.0) as usize * 8 + (y * 8.0) as usize] += 1;
        }
        let expected = KEYS as f64 / 64.0;
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
        assert!(chi2 < 130.0, "chi2 = {chi2}");
    }
}
