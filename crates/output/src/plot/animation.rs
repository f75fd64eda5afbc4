//! Animations as GIF and APNG files.

use std::io;
use std::path::Path;

use super::canvas::Canvas;
use super::raster::{self, Raster};
use super::{MARK, ParticlePlot, particles};
use crate::{OutputError, atomic_write};

/// Time of a picture, in hundredths of a second.
const SHOWN: u16 = 10;
/// The same of the last one.
const LAST_SHOWN: u16 = 150;
/// Colours are chosen from every tenth pixel: pictures have few.
const SAMPLING: i32 = 10;

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
            Movie::Gif => gif(rasters),
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

fn gif(rasters: impl ExactSizeIterator<Item = io::Result<Raster>>) -> io::Result<Vec<u8>> {
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
        let mut encoder =
            gif::Encoder::new(&mut bytes, width, height, &[]).map_err(io::Error::other)?;
        encoder
            .set_repeat(gif::Repeat::Infinite)
            .map_err(io::Error::other)?;
        for (number, raster) in rasters.enumerate() {
            let mut frame = gif::Frame::from_rgb_speed(width, height, &raster?.rgb, SAMPLING);
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
