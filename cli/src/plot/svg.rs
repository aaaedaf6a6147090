//! A small writer of SVG, for drawings that are no charts: panels of pixels, circles and outlines.

use std::fmt::Write;

use super::chart::Colour;

/// An SVG file in the making. Lengths are its own units, from the upper left.
#[derive(Clone, Debug)]
pub struct Svg {
    text: String,
}

/// Puts formatted text at the end of the file. Writing to a string cannot fail.
macro_rules! put {
    ($svg:expr, $($part:tt)*) => {
        let _ = writeln!($svg.text, $($part)*);
    };
}

impl Svg {
    /// A white ground.
    pub fn new(width: f64, height: f64) -> Self {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"sans-serif\" font-size=\"14\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        Self { text }
    }

    /// Moves the origin of all that `draw` draws to `[x, y]`.
    pub fn at(&mut self, [x, y]: [f64; 2], draw: impl FnOnce(&mut Self)) {
        put!(self, "<g transform=\"translate({x} {y})\">");
        draw(self);
        put!(self, "</g>");
    }

    /// Gives all that `draw` draws the attributes `style`.
    pub fn styled(&mut self, style: &str, draw: impl FnOnce(&mut Self)) {
        put!(self, "<g {style}>");
        draw(self);
        put!(self, "</g>");
    }

    /// A line of text whose middle is at `[x, y]`.
    pub fn text(&mut self, [x, y]: [f64; 2], text: &str) {
        let escaped = text.replace('&', "&amp;").replace('<', "&lt;");
        put!(
            self,
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{escaped}</text>"
        );
    }

    /// A circle; `style` holds its further attributes.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        put!(
            self,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" {style}/>"
        );
    }

    /// A path of line segments; `style` holds its further attributes.
    pub fn segments(&mut self, segments: impl Iterator<Item = [[f64; 2]; 2]>, style: &str) {
        let mut path = String::new();
        for [[x1, y1], [x2, y2]] in segments {
            let _ = write!(path, "M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}");
        }
        put!(self, "<path d=\"{path}\" {style}/>");
    }

    /// A gradient from the light at the upper left of a ball to its shade, for `fill="url(#NAME)"`.
    pub fn ball_gradient(&mut self, name: &str, light: &str, shade: &str) {
        put!(
            self,
            "<defs><radialGradient id=\"{name}\" cx=\"35%\" cy=\"30%\"><stop offset=\"0\" stop-color=\"{light}\"/>\
             <stop offset=\"1\" stop-color=\"{shade}\"/></radialGradient></defs>"
        );
    }

    /// Square pixels of an edge length in rows of `width`, the uppermost row first; neighbours of one colour become
    /// one rectangle.
    pub fn pixels(&mut self, edge: f64, width: usize, colours: &[Option<Colour>]) {
        put!(self, "<g shape-rendering=\"crispEdges\">");
        for (row, colours) in colours.chunks(width.max(1)).enumerate() {
            let mut from = 0;
            for run in colours.chunk_by(|a, b| a == b) {
                if let Some(Some([red, green, blue])) = run.first() {
                    put!(
                        self,
                        "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{edge:.2}\" \
                         fill=\"#{red:02x}{green:02x}{blue:02x}\"/>",
                        from as f64 * edge,
                        row as f64 * edge,
                        run.len() as f64 * edge
                    );
                }
                from += run.len();
            }
        }
        put!(self, "</g>");
    }

    /// The whole file.
    pub fn finish(self) -> String {
        self.text + "</svg>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_of_one_colour_become_one_rectangle() {
        let (red, blue) = (Some([255, 0, 0]), Some([0, 0, 255]));
        let mut svg = Svg::new(4.0, 4.0);
        svg.at([1.0, 0.0], |svg| {
            svg.pixels(1.0, 3, &[red, red, blue, None, None, red])
        });
        svg.text([2.0, 2.0], "a < b & c");
        let text = svg.finish();
        assert_eq!(text.matches("<rect x=").count(), 3);
        assert!(text.contains(
            "<rect x=\"0.00\" y=\"0.00\" width=\"2.00\" height=\"1.00\" fill=\"#ff0000\"/>"
        ));
        assert!(text.contains(">a &lt; b &amp; c</text>") && text.ends_with("</svg>\n"));
    }
}
