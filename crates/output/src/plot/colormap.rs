//! Colour maps whose steps look equal.

use super::canvas::Colour;

/// A map from 0..1 to colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColourMap {
    /// Dark blue over green to yellow; perceptually uniform, also for colour-blind readers and in
    /// grey (S. van der Walt and N. Smith 2015, public domain).
    #[default]
    Viridis,
    /// Blue over light grey to red, for quantities with a meaningful zero; its range is made
    /// symmetric about zero (K. Moreland 2009).
    CoolWarm,
}

impl ColourMap {
    /// Colour at `position`, clamped to 0..1; linear between 33 samples of the published table, at
    /// most two steps of 255 from it.
    pub(crate) fn at(self, position: f64) -> Colour {
        let table = match self {
            Self::Viridis => &VIRIDIS,
            Self::CoolWarm => &COOL_WARM,
        };
        let place = position.clamp(0.0, 1.0) * (SAMPLES - 1) as f64;
        let lower = (place as usize).min(SAMPLES - 2);
        super::canvas::mix(table[lower], table[lower + 1], place - lower as f64)
    }

    /// Whether the middle of the map means zero.
    pub(crate) fn is_diverging(self) -> bool {
        self == Self::CoolWarm
    }
}

const SAMPLES: usize = 33;

#[rustfmt::skip]
const VIRIDIS: [Colour; SAMPLES] = [
    [68, 1, 84], [71, 13, 96], [72, 24, 106], [72, 35, 116], [71, 45, 123], [69, 54, 129],
    [66, 64, 134], [63, 73, 137], [59, 82, 139], [55, 90, 141], [51, 99, 141], [47, 106, 142],
    [44, 114, 142], [41, 122, 142], [38, 129, 142], [35, 137, 142], [33, 144, 140], [31, 152, 139],
    [31, 159, 136], [33, 166, 133], [40, 174, 128], [49, 181, 123], [62, 188, 116], [76, 194, 108],
    [93, 201, 99], [110, 206, 88], [130, 211, 76], [150, 216, 63], [171, 220, 50], [192, 223, 36],
    [213, 226, 26], [234, 229, 26], [253, 231, 37],
];

#[rustfmt::skip]
const COOL_WARM: [Colour; SAMPLES] = [
    [59, 76, 192], [68, 90, 204], [77, 104, 215], [87, 117, 225], [98, 130, 234], [108, 142, 241],
    [119, 154, 247], [130, 165, 251], [141, 176, 254], [152, 185, 255], [163, 194, 254],
    [174, 201, 252], [184, 208, 249], [194, 213, 244], [204, 217, 238], [213, 219, 230],
    [221, 221, 221], [229, 216, 209], [236, 211, 197], [241, 204, 185], [244, 196, 173],
    [247, 187, 160], [247, 177, 148], [247, 166, 135], [244, 154, 123], [241, 141, 111],
    [236, 127, 99], [229, 112, 88], [222, 96, 77], [213, 80, 66], [203, 62, 56], [192, 40, 47],
    [180, 4, 38],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viridis_meets_published_values_between_the_samples() {
        // Entries of the table of 256 colours, times 255.
        for (index, expected) in [
            (0, [68.0, 1.0, 84.0]),
            (64, [59.0, 82.0, 139.0]),
            (128, [33.0, 145.0, 140.0]),
            (191, [92.0, 200.0, 99.0]),
            (255, [253.0, 231.0, 37.0]),
        ] {
            let colour = ColourMap::Viridis.at(f64::from(index) / 255.0);
            for (c, e) in colour.iter().zip(expected) {
                assert!((f64::from(*c) - e).abs() <= 2.0, "{index}: {colour:?}");
            }
        }
    }

    #[test]
    fn luminance_of_viridis_grows_steadily() {
        let luminance = |i: i32| {
            let [r, g, b] = ColourMap::Viridis.at(f64::from(i) / 50.0).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..50).all(|i| luminance(i) < luminance(i + 1)));
    }

    #[test]
    fn positions_outside_take_the_end_colours() {
        for map in [ColourMap::Viridis, ColourMap::CoolWarm] {
            assert_eq!(map.at(-3.0), map.at(0.0));
            assert_eq!(map.at(7.0), map.at(1.0));
        }
        assert_eq!(ColourMap::CoolWarm.at(0.5), [221, 221, 221]);
    }
}
