//! Input of a chart: panels, series and marks.

/// A chart with one pair of axes, part of a [`Figure`](crate::Figure). The axes are logarithmic, or
/// linear in [`Kind::Frames`].
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Heading above the axes.
    pub title: String,
    /// Kind of the panel, which decides how marks are joined and what else is drawn.
    pub kind: Kind,
    /// Label of the horizontal axis, with its unit.
    pub x: String,
    /// Label of the vertical axis, with its unit.
    pub y: String,
    /// Series of marks. The legend of the figure lists series in the order in which they first
    /// occur in its panels.
    pub series: Vec<Series>,
}

/// Kinds of panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Two costs, of which less is better: the Pareto front is drawn. The vertical value may be 0;
    /// such marks stand in a strip below the logarithmic axis.
    Front,
    /// Growth of a value: the marks of a series are joined, and a dashed line shows growth in
    /// proportion (slope 1 on the logarithmic axes).
    Growth,
    /// A value for each frame of a camera path, on linear axes from 0. The marks of a series are
    /// joined.
    Frames,
}

/// Marks with one name, colour and shape, for example the measurements of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend. It identifies the series: series with the same name in several panels
    /// have the same colour and shape.
    pub name: String,
    /// The marks, in the order in which lines join them in [`Kind::Growth`] and [`Kind::Frames`].
    pub marks: Vec<Mark>,
}

/// A measurement, drawn as one mark.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mark {
    /// Horizontal value in the unit of [`Panel::x`]: finite and above 0. In [`Kind::Frames`] it is
    /// the index of the frame, from 0.
    pub x: f64,
    /// Vertical value in the unit of [`Panel::y`]: finite and above 0. It may be 0 in all kinds but
    /// [`Kind::Growth`].
    pub y: f64,
    /// Ends of the horizontal error bar: finite and above 0, the smaller one first. `None` if there
    /// is no bar. Only [`Kind::Front`] draws it.
    pub spread: Option<[f64; 2]>,
    /// Size of the mark: an index into [`Figure::sizes`](crate::Figure::sizes); 0 if that list is
    /// empty.
    pub size: usize,
    /// Lines of text that a web page shows for the mark
    /// ([`Figure::to_page_svg`](crate::Figure::to_page_svg)); the first line is the mark's name.
    /// Empty for a mark without a name.
    pub about: String,
}

impl Panel {
    /// A panel of `series`, with the words at its two axes.
    pub fn new(kind: Kind, title: &str, [x, y]: [&str; 2], series: Vec<Series>) -> Self {
        Self {
            title: title.to_owned(),
            kind,
            x: x.to_owned(),
            y: y.to_owned(),
            series,
        }
    }
}

impl Series {
    /// The marks of the method `name`.
    pub fn new(name: &str, marks: Vec<Mark>) -> Self {
        let name = name.to_owned();
        Self { name, marks }
    }
}

impl Mark {
    /// Creates a mark of the smallest size, without an error bar or text.
    pub fn new(x: f64, y: f64) -> Self {
        Self {
            x,
            y,
            ..Self::default()
        }
    }

    /// Returns the mark's name: the first line of [`about`](Self::about).
    pub(crate) fn name(&self) -> &str {
        self.about.lines().next().unwrap_or_default()
    }
}
