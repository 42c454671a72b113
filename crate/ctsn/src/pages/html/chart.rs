//! Charts as inline SVG. Ink and grid get their colours from the page's style, so that charts follow light and dark.

use ctsn_rig::{Error, Result};
use maud::{Markup, PreEscaped, html};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, ValueFormatter};
use plotters::prelude::*;

/// Pixels, also of the narrowest screen it is to be read on.
const SIZE: (u32, u32) = (460, 280);
/// Colours of the series, readable on light and on dark.
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(0x2F, 0x7E, 0xD8),
    RGBColor(0xE0, 0x7B, 0x39),
    RGBColor(0x3A, 0xA7, 0x6D),
    RGBColor(0xA0, 0x62, 0xC8),
    RGBColor(0xD0, 0x45, 0x5C),
    RGBColor(0x8A, 0x83, 0x2E),
];

/// One line or cloud of points.
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// (x, y).
    pub points: Vec<(f64, f64)>,
    /// A line through the points; otherwise dots.
    pub line: bool,
}

/// What a chart shows.
pub struct Chart<'a> {
    /// Under the x axis.
    pub x: &'a str,
    /// Beside the y axis.
    pub y: &'a str,
    /// Whether the x axis, and whether the y axis is logarithmic; points that are not positive are then left out.
    pub logarithmic: [bool; 2],
    /// What is drawn; up to as many as there are [`COLOURS`].
    pub series: Vec<Series>,
}

impl Chart<'_> {
    /// The chart with its legend; nothing where there is no point to draw.
    pub fn draw(&self) -> Result<Markup> {
        let Some([x, y]) = self.ranges() else { return Ok(html! {}) };
        let mut svg = String::new();
        self.paint(&mut svg, x, y).map_err(|error| Error::Dataset(format!("chart {}: {error}", self.y)))?;
        let colour = |i: usize| {
            let RGBColor(r, g, b) = COLOURS[i % COLOURS.len()];
            format!("background:#{r:02x}{g:02x}{b:02x}")
        };
        Ok(html! {
            figure class="chart" {
                (PreEscaped(svg))
                figcaption {
                    @for (i, series) in self.series.iter().enumerate() {
                        span { i style=(colour(i)) {} (series.name) }
                    }
                }
            }
        })
    }

    /// Whether a point can be drawn.
    fn shown(&self, point: &(f64, f64)) -> bool {
        let fits = |value: f64, logarithmic: bool| value.is_finite() && (!logarithmic || value > 0.0);
        fits(point.0, self.logarithmic[0]) && fits(point.1, self.logarithmic[1])
    }

    fn ranges(&self) -> Option<[Axis; 2]> {
        let points = || self.series.iter().flat_map(|series| &series.points).filter(|point| self.shown(point));
        points().next()?;
        let range = |logarithmic: bool, part: fn(&(f64, f64)) -> f64| {
            let (low, high) =
                points().map(part).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
            Axis::around(low, high, logarithmic)
        };
        Some([range(self.logarithmic[0], |point| point.0), range(self.logarithmic[1], |point| point.1)])
    }

    fn paint(&self, svg: &mut String, x: Axis, y: Axis) -> std::result::Result<(), Box<dyn std::error::Error>> {
        let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        let mut chart = ChartBuilder::on(&root)
            .margin(8)
            .margin_right(18)
            .x_label_area_size(38)
            .y_label_area_size(50)
            .build_cartesian_2d(x, y)?;
        let grid = RGBColor(0x80, 0x80, 0x80).mix(0.25);
        chart
            .configure_mesh()
            .bold_line_style(grid)
            .light_line_style(TRANSPARENT)
            .x_labels(6)
            .y_labels(6)
            .x_desc(self.x)
            .y_desc(self.y)
            .label_style(("sans-serif", 15))
            .draw()?;
        for (i, series) in self.series.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            let points: Vec<(f64, f64)> = series.points.iter().filter(|point| self.shown(point)).copied().collect();
            if series.line {
                chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?;
            } else {
                chart.draw_series(points.into_iter().map(|point| Circle::new(point, 4, colour.filled())))?;
            }
        }
        root.present()?;
        Ok(())
    }
}

/// An axis, linear or logarithmic: one type, so that there is one type of chart.
#[derive(Clone)]
struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl Axis {
    fn around(low: f64, high: f64, logarithmic: bool) -> Self {
        if logarithmic {
            return Self { low: low / 1.15, high: high * 1.15, logarithmic };
        }
        // From zero, unless the values are much farther from it than from each other.
        let (low, high) = if low >= 0.0 && low < 0.7 * high { (0.0, high) } else { (low, high) };
        let room = if high > low { 0.04 * (high - low) } else { 0.5 };
        Self { low: if low == 0.0 { 0.0 } else { low - room }, high: high + room, logarithmic }
    }

    fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        limit.0 + (self.share(*value) * f64::from(limit.1 - limit.0)).round() as i32
    }

    /// 1, 2 and 5 times powers of ten.
    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let steps = |exponent: i32| [1.0, 2.0, 5.0].map(|step| step * 10.0_f64.powi(exponent));
        let inside = |value: &f64| (self.low..=self.high).contains(value);
        if self.logarithmic {
            let exponents = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
            return exponents.flat_map(steps).filter(inside).collect();
        }
        let most = hint.max_num_points().min(8) as f64;
        let finest = ((self.high - self.low) / most).log10().floor() as i32;
        let step = (finest..).flat_map(steps).find(|step| (self.high - self.low) / step <= most).unwrap_or(1.0);
        let first = (self.low / step).ceil() as i64;
        (first..).map(|i| i as f64 * step).take_while(|value| *value <= self.high).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    /// The shortest decimal text. A step times a whole number is short but for its rounding error.
    fn format_ext(&self, value: &f64) -> String {
        format!("{}", (value * 1e9).round() / 1e9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(points: Vec<(f64, f64)>, logarithmic: [bool; 2]) -> String {
        let series = Series { name: "net <work>".to_owned(), points, line: true };
        Chart { x: "epochs", y: "mm", logarithmic, series: vec![series] }.draw().expect("a chart").into_string()
    }

    #[test]
    fn a_chart_holds_its_axes_its_legend_and_a_line_that_falls() {
        let svg = drawn(vec![(1.0, 100.0), (10.0, 10.0), (100.0, 1.0)], [true, true]);
        for part in ["<svg", "epochs", "mm", "net &lt;work&gt;", "\n50\n", "<polyline"] {
            assert!(svg.contains(part), "wanted {part:?} in {svg}");
        }
        // On doubly logarithmic axes a power law is straight.
        let line = svg.rsplit("points=\"").next().expect("a line");
        let points = line.split('"').next().expect("its points").split_whitespace();
        let points: Vec<[f64; 2]> = points
            .map(|point| {
                let (x, y) = point.split_once(',').expect("a pair");
                [x, y].map(|value| value.parse().expect("a number"))
            })
            .collect();
        let [a, b, c] = points[..] else { panic!("wanted three points, found {points:?}") };
        assert!((a[0] + c[0] - 2.0 * b[0]).abs() <= 1.0 && (a[1] + c[1] - 2.0 * b[1]).abs() <= 1.0, "{points:?}");
        assert!(a[0] < b[0] && a[1] < b[1], "down is larger in SVG: {points:?}");
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        assert_eq!(drawn(vec![(1.0, f64::NAN)], [false, false]), "");
        assert_eq!(drawn(vec![(1.0, 0.0)], [false, true]), "");
        assert!(drawn(vec![(1.0, 2.0)], [false, false]).contains("<svg"), "a single point has no extent");
    }
}
