//! Parts of a chart.

/// One pair of axes: logarithmic, or linear in [`Kind::Bars`] and [`Kind::Frames`].
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Heading above it.
    pub title: String,
    /// Kind of the panel, which decides the lines beside the marks.
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
    /// Costs in both directions, less is better: the Pareto front. Zero is allowed upwards and has
    /// a strip of its own.
    Front,
    /// How something grows: the marks of a series are joined, and a dashed line has slope 1.
    Growth,
    /// A bar for each mark, in groups of these names, upwards from 0 on a linear axis.
    Bars(Vec<String>),
    /// The frames of a path to the right and a figure of each upwards, both on linear axes from 0:
    /// the marks of a series are joined.
    Frames,
}

/// Marks of one colour and shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// The marks; lines join them in this order.
    pub marks: Vec<Mark>,
}

/// A measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// To the right: finite and above 0; in [`Kind::Bars`] the index of the group, in
    /// [`Kind::Frames`] that of the frame.
    pub x: f64,
    /// Upwards: finite and above 0; in all kinds but [`Kind::Growth`] also 0.
    pub y: f64,
    /// Index into [`Figure::sizes`](crate::Figure::sizes); 0 where these are empty.
    pub size: usize,
    /// Lines that a page tells of it, the first one its name.
    pub about: String,
}

impl Mark {
    /// A mark of the smallest size of which there is no more to tell.
    pub fn new(x: f64, y: f64) -> Self {
        let about = String::new();
        Self {
            x,
            y,
            size: 0,
            about,
        }
    }

    /// Name: the first line of what there is to tell of it.
    pub(crate) fn name(&self) -> &str {
        self.about.lines().next().unwrap_or_default()
    }
}
