//! Animations as GIF and APNG files.

use std::collections::HashMap;
use std::io;
use std::path::Path;

use super::canvas::{Canvas, Colour, INK, PAPER, mix};
use super::raster::{self, Raster};
use super::{ColourMap, MARK, ParticlePlot, particles};
use crate::{OutputError, atomic_write};

/// Time of a picture, in hundredths of a second.
const SHOWN: u16 = 10;
/// The same of the last one.
const LAST_SHOWN: u16 = 150;
/// Colours of a GIF: so many shades from text to paper, of the field's colours, of these darkened as
/// for edges and rims, and of these brightened as for highlights.
const SHADES: [u8; 4] = [24, 128, 56, 40];

/// The files an animation can be written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Movie {
    /// At most 256 colours per picture; shown by everything.
    Gif,
    /// Every colour; shown by browsers.
    Apng,
}

/// Pictures of a body one after the other, ten per second, in an endless loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    pictures: Vec<Canvas>,
    colours: ColourMap,
}

impl Animation {
    /// Bodies one after the other under a heading, with the scale, window and colours they would
    /// have side by side in [`Figure::panels`](super::Figure::panels).
    ///
    /// # Errors
    /// Those of [`Figure::particles`](super::Figure::particles).
    pub fn new(heading: &str, plots: &[ParticlePlot]) -> Result<Self, OutputError> {
        Ok(Self {
            pictures: particles::sequence(heading, plots)?,
            colours: plots[0].colours,
        })
    }

    /// Writes the file, atomically, with one pixel per CSS pixel.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn save(&self, movie: Movie, path: &Path) -> Result<(), OutputError> {
        let bytes = self.encode(movie).map_err(OutputError::io("draw", path))?;
        atomic_write(path, |writer| writer.write_all(&bytes))
    }

    fn encode(&self, movie: Movie) -> io::Result<Vec<u8>> {
        // Titles may make some pictures wider than others.
        let page = self.pictures.iter().fold([0.0_f64; 2], |page, picture| {
            [page[0].max(picture.width), page[1].max(picture.height)]
        });
        let rasters = self
            .pictures
            .iter()
            .map(|picture| raster::moving(picture, page));
        match movie {
            Movie::Gif => gif(rasters, &palette(self.colours)),
            Movie::Apng => apng(rasters, self.pictures.len()),
        }
    }
}

/// Time of picture `number` of `count`.
fn shown(number: usize, count: usize) -> u16 {
    if number + 1 == count {
        LAST_SHOWN
    } else {
        SHOWN
    }
}

fn apng(rasters: impl Iterator<Item = io::Result<Raster>>, count: usize) -> io::Result<Vec<u8>> {
    let mut rasters = rasters.peekable();
    let Some(Ok(first)) = rasters.peek() else {
        return Err(io::Error::other("no picture"));
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, first.width, first.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let frames = u32::try_from(count).map_err(io::Error::other)?;
    encoder.set_animated(frames, 0)?;
    encoder.add_text_chunk("Software".to_owned(), MARK.to_owned())?;
    let mut writer = encoder.write_header()?;
    for (number, raster) in rasters.enumerate() {
        writer.set_frame_delay(shown(number, count), 100)?;
        writer.write_image_data(&raster?.rgb)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// The colours of all pictures: those that one picture happens to have would change the colour bar
/// from picture to picture.
fn palette(colours: ColourMap) -> Vec<Colour> {
    let shades = |count: u8| (0..count).map(move |i| f64::from(i) / f64::from(count - 1));
    let [greys, plain, dark, bright] = SHADES;
    let greys = shades(greys).map(|share| mix(INK, PAPER, share));
    let plain = shades(plain).map(|place| colours.at(place));
    let dark = shades(dark).map(|place| mix(colours.at(place), INK, 0.35));
    let bright = shades(bright).map(|place| mix(colours.at(place), PAPER, 0.4));
    greys.chain(plain).chain(dark).chain(bright).collect()
}

/// Numbers of the nearest colours of a palette.
fn indexed(rgb: &[u8], palette: &[Colour], known: &mut HashMap<Colour, u8>) -> Vec<u8> {
    let distance = |a: Colour, b: Colour| -> u32 {
        let parts = a.into_iter().zip(b);
        parts.map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    let nearest = |colour: Colour| -> u8 {
        let numbers = (0..=u8::MAX).zip(palette);
        let nearest = numbers.min_by_key(|(_, other)| distance(colour, **other));
        nearest.map_or(0, |(number, _)| number)
    };
    let pixels = rgb.chunks_exact(3).map(|p| [p[0], p[1], p[2]]);
    pixels
        .map(|colour| *known.entry(colour).or_insert_with(|| nearest(colour)))
        .collect()
}

fn gif(
    rasters: impl ExactSizeIterator<Item = io::Result<Raster>>,
    palette: &[Colour],
) -> io::Result<Vec<u8>> {
    let count = rasters.len();
    let mut rasters = rasters.peekable();
    let too_large = |_| io::Error::other("a GIF has at most 65535 x 65535 pixels");
    let Some(Ok(first)) = rasters.peek() else {
        return Err(io::Error::other("no picture"));
    };
    let width = u16::try_from(first.width).map_err(too_large)?;
    let height = u16::try_from(first.height).map_err(too_large)?;
    let mut bytes = Vec::new();
    {
        let mut encoder = gif::Encoder::new(&mut bytes, width, height, palette.as_flattened())
            .map_err(io::Error::other)?;
        encoder
            .set_repeat(gif::Repeat::Infinite)
            .map_err(io::Error::other)?;
        let mut known = HashMap::new();
        for (number, raster) in rasters.enumerate() {
            let pixels = indexed(&raster?.rgb, palette, &mut known);
            let mut frame = gif::Frame::from_indexed_pixels(width, height, pixels, None);
            frame.delay = shown(number, count);
            encoder.write_frame(&frame).map_err(io::Error::other)?;
        }
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_tensor::Vec3;

    /// Two particles that move apart, and their values grow.
    fn animation() -> Animation {
        let positions: Vec<[Vec3; 2]> = (1..=3)
            .map(|i| [Vec3::zeros(), Vec3::new(f64::from(i), 1.0, 0.0)])
            .collect();
        let values: Vec<[f64; 2]> = (1..=3).map(|i| [0.0, f64::from(i)]).collect();
        let plots: Vec<ParticlePlot> = positions
            .iter()
            .zip(&values)
            .map(|(x, v)| ParticlePlot::new(x, v, "speed", "m/s", 0.5))
            .collect();
        Animation::new("apart", &plots).unwrap()
    }

    #[test]
    fn colours_of_a_gif_do_not_depend_on_the_picture() {
        let palette = palette(ColourMap::Viridis);
        assert_eq!(palette.len(), SHADES.map(usize::from).iter().sum::<usize>());
        assert!(palette.len() <= 256 && palette.contains(&PAPER) && palette.contains(&INK));
        let mut known = HashMap::new();
        for i in 0..=1000 {
            let colour = ColourMap::Viridis.at(f64::from(i) / 1000.0);
            let number = indexed(&colour, &palette, &mut known)[0];
            let found = palette[usize::from(number)];
            // Half the distance of two of 128 shades of a range of about 256.
            let parts = colour.iter().zip(found);
            assert!(parts.into_iter().all(|(a, b)| a.abs_diff(b) <= 3), "{i}");
        }
    }

    #[test]
    fn every_picture_is_in_both_files_with_one_size() {
        let animation = animation();
        let bytes = animation.encode(Movie::Apng).unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(&bytes))
            .read_info()
            .unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        let mut pictures = Vec::new();
        for _ in 0..3 {
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            pictures.push(pixels);
        }
        assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);

        let bytes = animation.encode(Movie::Gif).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        let mut delays = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            delays.push(frame.delay);
        }
        assert_eq!(delays, [SHOWN, SHOWN, LAST_SHOWN]);
    }

    #[test]
    fn the_colour_of_a_value_and_the_place_of_a_particle_do_not_change_between_pictures() {
        // The first particle stays where it is with value 0: its pixels are the same in all.
        let animation = animation();
        let first = &animation.pictures[0];
        let page = [first.width, first.height];
        let rasters: Vec<Raster> = animation
            .pictures
            .iter()
            .map(|picture| raster::moving(picture, page).unwrap())
            .collect();
        let dark = [68, 1, 84];
        let places = |raster: &Raster| -> Vec<usize> {
            let pixels = raster.rgb.chunks_exact(3).enumerate();
            // The colour bar at the right edge has this colour too.
            pixels
                .filter(|(at, rgb)| *rgb == dark && (*at as u32 % raster.width) < raster.width / 2)
                .map(|(at, _)| at)
                .collect()
        };
        let first = places(&rasters[0]);
        assert!(!first.is_empty());
        assert!(rasters.iter().all(|raster| places(raster) == first));
    }
}
