//! Errors against time as an SVG figure: [`Figure`]. It draws numbers and computes none.

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const SIZE: (u32, u32) = (1000, 760);
const TITLE_HEIGHT: u32 = 44;
const LEGEND_HEIGHT: u32 = 36;
const INK: RGBColor = RGBColor(51, 51, 51);
const FAINT: RGBColor = RGBColor(225, 225, 225);
const SHADE: RGBColor = RGBColor(236, 233, 226);

/// One colour per method that colour-blind people can tell apart (Okabe and Ito 2008).
const COLOURS: [RGBColor; 5] =
    [RGBColor(153, 153, 153), RGBColor(230, 159, 0), RGBColor(86, 180, 233), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];

/// Smallest error that is drawn (mm or degrees); exact zeros would be off a logarithmic axis.
const FLOOR: f64 = 0.01;

type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, LogCoord<f64>>>;
type Area<'b> = DrawingArea<SVGBackend<'b>, Shift>;

/// An event on the time axis.
#[derive(Clone, Debug)]
pub struct Mark {
    /// When (s).
    pub time: f64,
    /// What.
    pub name: String,
}

/// The errors of one method: pairs of time (s) and error.
#[derive(Clone, Debug)]
pub struct Series {
    /// The method.
    pub name: &'static str,
    /// Position errors (mm).
    pub position: Vec<(f64, f64)>,
    /// Angle errors (degrees).
    pub angle: Vec<(f64, f64)>,
}

/// Errors of several methods in one experiment.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Title.
    pub title: String,
    /// Times that are shown (s).
    pub span: [f64; 2],
    /// When the camera goes dark (s).
    pub dark_from: Option<f64>,
    /// First contacts.
    pub contacts: Vec<Mark>,
    /// Methods.
    pub series: Vec<Series>,
}

/// One of the two panels.
struct Panel {
    label: &'static str,
    errors: fn(&Series) -> &[(f64, f64)],
    names_contacts: bool,
    time_label: &'static str,
}

impl Figure {
    /// The figure as SVG text.
    pub fn to_svg(&self) -> Result<String> {
        let mut svg = String::new();
        self.draw(&SVGBackend::with_string(&mut svg, SIZE).into_drawing_area())
            .map_err(|error| anyhow!("the figure cannot be drawn: {error}"))?;
        Ok(svg)
    }

    fn draw(&self, root: &Area<'_>) -> Result<()> {
        root.fill(&WHITE).map_err(said)?;
        let (head, body) = root.split_vertically(TITLE_HEIGHT);
        let title = TextStyle::from(("sans-serif", 22).into_font()).color(&INK);
        head.draw_text(&self.title, &title, (92, 14)).map_err(said)?;
        let (legend, panels) = body.split_vertically(LEGEND_HEIGHT);
        self.draw_legend(&legend)?;
        let (upper, lower) = panels.split_vertically(panels.dim_in_pixel().1 / 2 - 12);
        self.draw_panel(&upper, &Panel { label: "position error [mm]", errors: |s| &s.position, names_contacts: true, time_label: "" })?;
        self.draw_panel(
            &lower,
            &Panel { label: "angle error [deg]", errors: |s| &s.angle, names_contacts: false, time_label: "time [s]" },
        )?;
        root.present().map_err(said)
    }

    fn draw_legend(&self, area: &Area<'_>) -> Result<()> {
        let style = TextStyle::from(("sans-serif", 16).into_font()).color(&INK);
        let mut x = 92;
        for (series, colour) in self.series.iter().zip(COLOURS) {
            area.draw(&PathElement::new(vec![(x, 14), (x + 28, 14)], colour.stroke_width(4))).map_err(said)?;
            area.draw_text(series.name, &style, (x + 36, 6)).map_err(said)?;
            x += 64 + (7.2 * series.name.len() as f64) as i32;
        }
        if self.dark_from.is_some() {
            area.draw(&Rectangle::new([(x, 6), (x + 28, 22)], SHADE.filled())).map_err(said)?;
            area.draw_text("camera dark", &style, (x + 36, 6)).map_err(said)?;
        }
        Ok(())
    }

    fn draw_panel(&self, area: &Area<'_>, panel: &Panel) -> Result<()> {
        let [from, to] = self.span;
        let [low, high] = self.limits(panel);
        let mut axes = ChartBuilder::on(area)
            .margin_left(14)
            .margin_right(24)
            .margin_top(if panel.names_contacts { 26 } else { 4 })
            .x_label_area_size(if panel.time_label.is_empty() { 24 } else { 46 })
            .y_label_area_size(78)
            .build_cartesian_2d(from..to, (low..high).log_scale())
            .map_err(said)?;
        self.draw_shade(&mut axes, [low, high])?;
        axes.configure_mesh()
            .disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(FAINT)
            .axis_style(INK)
            .x_desc(panel.time_label)
            .y_desc(panel.label)
            .x_label_formatter(&|time| format!("{time}"))
            .y_label_formatter(&|error| format!("{error}"))
            .label_style(("sans-serif", 15).into_font().color(&INK))
            .axis_desc_style(("sans-serif", 17).into_font().color(&INK))
            .draw()
            .map_err(said)?;
        self.draw_contacts(&mut axes, panel, [low, high])?;
        self.draw_errors(&mut axes, panel)
    }

    /// Whole decades that hold the errors shown.
    fn limits(&self, panel: &Panel) -> [f64; 2] {
        let shown =
            self.series.iter().flat_map(|series| (panel.errors)(series)).filter(|(time, _)| (self.span[0]..=self.span[1]).contains(time));
        let (low, high) = shown.fold((f64::INFINITY, FLOOR), |(low, high), (_, error)| (low.min(error.max(FLOOR)), high.max(*error)));
        [10_f64.powi(low.log10().floor() as i32).max(FLOOR), 1.3 * high]
    }

    /// Grey where the camera is dark.
    fn draw_shade(&self, axes: &mut Axes<'_, '_>, [low, high]: [f64; 2]) -> Result<()> {
        let Some(from) = self.dark_from else { return Ok(()) };
        let corners = [(from, low), (self.span[1], high)];
        axes.draw_series([Rectangle::new(corners, SHADE.filled())]).map_err(said)?;
        Ok(())
    }

    /// A dashed line at each first contact, with its name above the upper panel.
    fn draw_contacts(&self, axes: &mut Axes<'_, '_>, panel: &Panel, [low, high]: [f64; 2]) -> Result<()> {
        for mark in &self.contacts {
            let line = [(mark.time, low), (mark.time, high)];
            axes.draw_series(DashedLineSeries::new(line, 4, 4, INK.mix(0.6).stroke_width(1))).map_err(said)?;
        }
        let style = TextStyle::from(("sans-serif", 14).into_font()).color(&INK).pos(Pos::new(HPos::Center, VPos::Bottom));
        let names = if panel.names_contacts { self.named_contacts() } else { Vec::new() };
        // a little above the axis's end
        let names = names.into_iter().map(|mark| Text::new(mark.name, (mark.time, 1.04 * high), style.clone()));
        for name in names {
            axes.plotting_area().draw(&name).map_err(said)?;
        }
        Ok(())
    }

    /// Names of contacts; those that would cover each other are told together.
    fn named_contacts(&self) -> Vec<Mark> {
        let width = self.span[1] - self.span[0];
        let mut marks = self.contacts.clone();
        marks.sort_by(|a, b| a.time.total_cmp(&b.time));
        let mut named: Vec<Mark> = Vec::new();
        for mark in marks {
            match named.last_mut() {
                Some(last) if mark.time - last.time < 0.08 * width => last.name = format!("{}, {}", last.name, mark.name),
                _ => named.push(mark),
            }
        }
        named
    }

    fn draw_errors(&self, axes: &mut Axes<'_, '_>, panel: &Panel) -> Result<()> {
        // the later ones first: methods that agree cover each other, and those with less to go by are then in sight
        for (series, colour) in self.series.iter().zip(COLOURS).rev() {
            let shown = (panel.errors)(series).iter().filter(|(time, _)| (self.span[0]..=self.span[1]).contains(time));
            let points = shown.map(|(time, error)| (*time, error.max(FLOOR)));
            axes.draw_series(LineSeries::new(points, colour.stroke_width(2))).map_err(said)?;
        }
        Ok(())
    }
}

fn said(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("{error}")
}
