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
    /// Dark blue over grey to yellow, nearly the same for colour-blind readers (J. Nunez, C.
    /// Anderton and R. Renslow 2018).
    Cividis,
    /// Black over red to light yellow (van der Walt and Smith 2015, public domain).
    Inferno,
    /// Blue over red to yellow (the same).
    Plasma,
    /// Black over purple to light yellow (the same).
    Magma,
}

impl ColourMap {
    /// All of them with the names they are known by.
    pub const ALL: [(&'static str, Self); 6] = [
        ("viridis", Self::Viridis),
        ("cividis", Self::Cividis),
        ("inferno", Self::Inferno),
        ("plasma", Self::Plasma),
        ("magma", Self::Magma),
        ("blue-red", Self::CoolWarm),
    ];

    /// Red, green and blue at equal distances from the first colour to the last.
    pub(crate) fn table(self) -> &'static [Colour; SAMPLES] {
        match self {
            Self::Viridis => &VIRIDIS,
            Self::CoolWarm => &COOL_WARM,
            Self::Cividis => &CIVIDIS,
            Self::Inferno => &INFERNO,
            Self::Plasma => &PLASMA,
            Self::Magma => &MAGMA,
        }
    }

    /// Colour at `position`, clamped to 0..1; linear between 33 samples of the published table, at
    /// most two steps of 255 from it.
    pub(crate) fn at(self, position: f64) -> Colour {
        let table = self.table();
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

#[rustfmt::skip]
const CIVIDIS: [Colour; SAMPLES] = [
    [0, 34, 78], [0, 40, 91], [0, 46, 106], [5, 51, 113], [26, 56, 111], [39, 62, 110],
    [50, 67, 109], [59, 73, 108], [67, 78, 108], [75, 84, 108], [83, 90, 109], [90, 95, 110],
    [97, 101, 111], [104, 106, 113], [111, 112, 115], [118, 118, 118], [125, 124, 120],
    [132, 130, 121], [140, 136, 120], [147, 142, 120], [155, 148, 118], [163, 154, 116],
    [171, 160, 114], [180, 167, 111], [188, 174, 108], [196, 180, 104], [205, 187, 99],
    [213, 194, 94], [222, 201, 88], [231, 209, 80], [240, 216, 70], [249, 224, 58], [254, 232, 56],
];

#[rustfmt::skip]
const INFERNO: [Colour; SAMPLES] = [
    [0, 0, 4], [4, 3, 18], [11, 7, 36], [21, 11, 55], [33, 12, 74], [47, 10, 91], [61, 9, 101],
    [74, 12, 107], [87, 16, 110], [100, 21, 110], [113, 25, 110], [125, 30, 109], [138, 34, 106],
    [151, 39, 102], [163, 44, 97], [176, 49, 91], [188, 55, 84], [199, 62, 76], [210, 70, 68],
    [219, 80, 59], [228, 90, 49], [235, 102, 40], [241, 115, 29], [246, 128, 19], [249, 142, 9],
    [251, 157, 7], [252, 172, 17], [251, 188, 33], [249, 203, 53], [245, 219, 76], [242, 234, 105],
    [243, 246, 138], [252, 255, 164],
];

#[rustfmt::skip]
const PLASMA: [Colour; SAMPLES] = [
    [13, 8, 135], [34, 6, 144], [49, 5, 151], [63, 4, 156], [76, 2, 161], [89, 1, 165],
    [102, 0, 167], [114, 1, 168], [126, 3, 168], [138, 9, 165], [149, 17, 161], [160, 26, 156],
    [170, 35, 149], [179, 44, 142], [188, 53, 135], [196, 62, 127], [204, 71, 120], [211, 81, 113],
    [218, 90, 106], [224, 99, 99], [230, 108, 92], [235, 118, 85], [240, 128, 78], [245, 139, 71],
    [248, 149, 64], [251, 161, 57], [253, 172, 51], [254, 184, 44], [253, 197, 39], [252, 210, 37],
    [248, 223, 37], [244, 237, 39], [240, 249, 33],
];

#[rustfmt::skip]
const MAGMA: [Colour; SAMPLES] = [
    [0, 0, 4], [3, 3, 18], [10, 8, 34], [19, 13, 52], [29, 17, 71], [41, 17, 90], [54, 16, 107],
    [68, 15, 118], [81, 18, 124], [93, 23, 127], [106, 28, 129], [118, 33, 129], [131, 38, 129],
    [144, 42, 129], [156, 46, 127], [170, 51, 125], [183, 55, 121], [196, 60, 117], [208, 65, 111],
    [220, 72, 105], [231, 82, 99], [239, 93, 94], [245, 107, 92], [249, 121, 93], [252, 137, 97],
    [253, 152, 105], [254, 167, 114], [254, 182, 124], [254, 196, 136], [254, 211, 149],
    [253, 226, 163], [252, 240, 178], [252, 253, 191],
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
    fn luminance_grows_steadily_where_no_value_is_the_middle() {
        for (name, map) in ColourMap::ALL {
            let luminance = |i: i32| {
                let [r, g, b] = map.at(f64::from(i) / 50.0).map(f64::from);
                0.2126 * r + 0.7152 * g + 0.0722 * b
            };
            let is_steady = (0..50).all(|i| luminance(i) < luminance(i + 1));
            assert_eq!(is_steady, !map.is_diverging(), "{name}");
        }
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
