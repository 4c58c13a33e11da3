//! Input of a chart: panels, series and marks.

/// A chart with one pair of axes. The axes are logarithmic, or linear in [`Kind::Bars`] and
/// [`Kind::Frames`].
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
    /// Series in the order of the legend.
    pub series: Vec<Series>,
}

/// Kinds of panels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Two costs, of which less is better: the Pareto front is drawn. The vertical value may be 0;
    /// zero has a strip of its own.
    Front,
    /// Growth of a value: the marks of a series are joined, and a dashed line shows slope 1.
    Growth,
    /// A bar for each mark, upwards from 0 on a linear axis. The list holds the names of the groups
    /// of bars.
    Bars(Vec<String>),
    /// A value for each frame of a camera path, on linear axes from 0. The marks of a series are
    /// joined.
    Frames,
}

/// Marks with the same name, colour and shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend. It identifies the series: the same name has the same look in all panels.
    pub name: String,
    /// The marks; lines join them in this order.
    pub marks: Vec<Mark>,
}

/// A measurement, drawn as one mark.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Horizontal value: finite and above 0. In [`Kind::Bars`] it is the index of the group, in
    /// [`Kind::Frames`] the index of the frame, both from 0.
    pub x: f64,
    /// Vertical value: finite and above 0. It may be 0 in all kinds but [`Kind::Growth`].
    pub y: f64,
    /// Ends of the horizontal error bar: finite and above 0, the smaller one first. `None` if there
    /// is no bar. Only [`Kind::Front`] draws it.
    pub spread: Option<[f64; 2]>,
    /// Size of the mark: an index into [`Figure::sizes`](crate::Figure::sizes); 0 if that list is
    /// empty.
    pub size: usize,
    /// Lines of text that a page shows for the mark; the first line is the mark's name.
    pub about: String,
}

impl Mark {
    /// Creates a mark of the smallest size, without an error bar and text.
    pub fn new(x: f64, y: f64) -> Self {
        let about = String::new();
        Self {
            x,
            y,
            spread: None,
            size: 0,
            about,
        }
    }

    /// Returns the name: the first line of the text.
    pub(crate) fn name(&self) -> &str {
        self.about.lines().next().unwrap_or_default()
    }
}
