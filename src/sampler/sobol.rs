//! The first two dimensions of Sobol's sequence, Owen-scrambled and shuffled.

use super::mix;

/// A point of a scrambled and shuffled two-dimensional Sobol sequence, in [0, 1)^2.
///
/// `index` runs from 0 within a block of 2^`index_bits` points; `key` picks the scramble.
#[inline]
pub fn owen_sobol_2d(index: u32, index_bits: u32, key: u64) -> [f32; 2] {
    let (low, high) = (key as u32, (key >> 32) as u32);
    // Shuffling within the block: any power-of-two prefix stays a net.
    let mask = ((1_u64 << index_bits) - 1) as u32;
    // The shuffle has its own key: with one of the scrambles' the leading bits would cancel.
    // Scrambled from the highest bit down, so that neighbours end up far apart; from the
    // lowest up, the halves of one name would fall on the halves of every other.
    let shuffled = laine_karras(index.reverse_bits(), (mix(key) >> 32) as u32).reverse_bits() & mask;
    let x = laine_karras(shuffled, low).reverse_bits();
    let y = laine_karras(second_dimension(shuffled).reverse_bits(), high).reverse_bits();
    [to_unit(x), to_unit(y)]
}

/// Radical inverse in Sobol's second dimension, as bits below the binary point.
///
/// Its direction numbers are the rows of Pascal's triangle modulo 2.
#[inline]
fn second_dimension(mut index: u32) -> u32 {
    let mut direction = 1_u32 << 31;
    let mut bits = 0;
    while index != 0 {
        if index & 1 != 0 {
            bits ^= direction;
        }
        direction ^= direction >> 1;
        index >>= 1;
    }
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
