//! Thread that traces the reference for the shown frame: first every ninth pixel of each row and
//! column, then every third, then all. Each traced pixel is exact.

use glam::DVec2;
use skiagraph_reference::{Error, GroundTruth, Oracle, OracleMode, Progress, ground_truth};
use skiagraph_scene::{Camera, LightKind, Scene};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;

/// Distances in pixels, along rows and columns, between traced pixels of the first, second and
/// third answer to a question. They are odd, so that the centre of a block of so many pixels is
/// that of a pixel.
pub const STRIDES: [u32; 3] = [9, 3, 1];

/// Number of shadow rays per pixel to a light with an extent; more would be too slow for a live
/// picture.
pub const SAMPLES: u32 = 64;

/// Question to the reference ray tracer: the picture whose pixels it judges, lit or in shadow.
#[derive(Clone)]
pub struct Question {
    /// The scene that the picture shows.
    pub scene: Arc<Scene>,
    /// The camera of the picture, with its viewport.
    pub camera: Camera,
    /// The light to judge.
    pub light: LightKind,
    /// Index of the visible triangle of each pixel, row by row from the top left;
    /// [`BACKGROUND`](skiagraph_reference::BACKGROUND) for pixels without one.
    pub primitives: Arc<Vec<u32>>,
    /// Flag that [`GroundTruthThread::ask`] and [`forget`](GroundTruthThread::forget) set once the
    /// answer is not needed any more.
    pub outdated: Arc<AtomicBool>,
}

impl Question {
    /// True if two questions have the same scene, camera, light and primitives.
    pub fn is_like(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.camera, self.light) == (other.camera, other.light)
            && self.primitives == other.primitives
    }
}

/// Answer of the reference for some or all pixels of a picture.
pub struct Answer {
    /// The question that this answers.
    pub question: Question,
    /// Distance in pixels, along rows and columns, from each judged pixel to the next, one of
    /// [`STRIDES`]; 1 if all pixels are judged.
    pub stride: u32,
    /// Ground truth of the judged pixels only, as a picture of [`thinned_size`], or the reason why
    /// there is none.
    pub ground_truth: Result<GroundTruth, String>,
}

/// Handle of the thread that traces the reference.
pub struct GroundTruthThread {
    questions: mpsc::Sender<Question>,
    last: Option<Question>,
}

impl GroundTruthThread {
    /// Starts the thread, which calls `tell` with each answer: to each question at most one for
    /// each of [`STRIDES`]. It ends when the handle is dropped.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(tell: impl Fn(Answer) + Send + 'static) -> std::io::Result<Self> {
        let (questions, asked) = mpsc::channel();
        thread::Builder::new()
            .name("reference".into())
            .spawn(move || work(&asked, &tell))?;
        Ok(Self {
            questions,
            last: None,
        })
    }

    /// Asks a question and cancels the one before. Does nothing if the last question [was
    /// alike](Question::is_like).
    pub fn ask(&mut self, question: &Question) {
        let mut last = self.last.iter();
        if last.any(|last| last.is_like(question)) {
            return;
        }
        self.forget();
        let _ = self.questions.send(question.clone());
        self.last = Some(question.clone());
    }

    /// Cancels the last question.
    pub fn forget(&mut self) {
        if let Some(last) = self.last.take() {
            last.outdated.store(true, Ordering::Relaxed);
        }
    }
}

impl Drop for GroundTruthThread {
    fn drop(&mut self) {
        self.forget();
    }
}

fn work(asked: &mpsc::Receiver<Question>, tell: &impl Fn(Answer)) {
    let mut next = asked.recv().ok();
    while let Some(first) = next.take() {
        let scene = first.scene.clone();
        // The hierarchy is built once for a scene.
        let oracle = Oracle::new(&scene.mesh);
        let mut question = first;
        loop {
            if Arc::ptr_eq(&question.scene, &scene) {
                answer(&oracle, &question, tell);
            } else {
                next = Some(question);
                break;
            }
            match asked.recv() {
                Ok(another) => question = asked.try_iter().last().unwrap_or(another),
                Err(_) => return,
            }
        }
    }
}

fn answer(oracle: &Oracle, question: &Question, tell: &impl Fn(Answer)) {
    for stride in STRIDES {
        let Some((camera, primitives)) = thinned(&question.camera, &question.primitives, stride)
        else {
            continue;
        };
        let progress = Progress {
            rows_done: &|_| (),
            interrupted: &question.outdated,
        };
        let how = (OracleMode::Exact, SAMPLES);
        let ground_truth =
            ground_truth(oracle, &camera, question.light, &primitives, how, progress);
        if matches!(ground_truth, Err(Error::Interrupted)) {
            return;
        }
        tell(Answer {
            question: question.clone(),
            stride,
            ground_truth: ground_truth.map_err(|error| error.to_string()),
        });
    }
}

/// Returns the width and height of a picture of `size` pixels if only the middle one of every
/// `stride` pixels in rows and columns is kept.
pub fn thinned_size(size: [u32; 2], stride: u32) -> [u32; 2] {
    size.map(|edge| edge / stride)
}

/// Returns the middle one of every `stride` values in each row and column. `values` are those of a
/// picture of `size` pixels, row by row; the result is one of [`thinned_size`].
pub fn thin<T: Copy>(values: &[T], size: [u32; 2], stride: u32) -> Vec<T> {
    let [width, height] = thinned_size(size, stride).map(|edge| edge as usize);
    let place = |at: usize| at * stride as usize + stride as usize / 2;
    let rows = (0..height).map(|y| place(y) * size[0] as usize);
    rows.flat_map(|row| (0..width).map(move |x| row + place(x)))
        .map(|index| values[index])
        .collect()
}

/// The camera whose pixels have the centres of those that are left, and their primitives; `None`
/// where none are left.
fn thinned(camera: &Camera, primitives: &[u32], stride: u32) -> Option<(Camera, Vec<u32>)> {
    let size = camera.viewport;
    let viewport = thinned_size(size, stride);
    if viewport.contains(&0) {
        return None;
    }
    let share = |axis: usize| f64::from(viewport[axis] * stride) / f64::from(size[axis]);
    // The cut at the right and below moves the picture's middle.
    let cut = |axis: usize| f64::from(viewport[axis] * stride) - f64::from(size[axis]);
    let jitter = (camera.jitter * 2.0 + DVec2::new(cut(0), cut(1))) / (2.0 * f64::from(stride));
    let camera = Camera {
        viewport,
        half_width: camera.half_width * share(0),
        half_height: camera.half_height * share(1),
        jitter,
        ..*camera
    };
    Some((camera, thin(primitives, size, stride)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use skiagraph_scene::View;

    #[test]
    fn thinned_pixels_look_where_theirs_did() {
        let view = View {
            eye: DVec3::new(1.0, 2.0, 3.0),
            direction: DVec3::new(0.3, -0.2, -1.0),
            fov_y_degrees: 50.0,
            far: 100.0,
            ..View::default()
        };
        for size in [[64, 48], [27, 18], [61, 43]] {
            let whole = view.camera(size);
            let numbers: Vec<u32> = (0..size[0] * size[1]).collect();
            for stride in STRIDES {
                let (camera, kept) = thinned(&whole, &numbers, stride).unwrap();
                let [width, height] = camera.viewport;
                for (x, y) in [(0, 0), (width - 1, height - 1), (width / 2, 0)] {
                    let number = kept[(y * width + x) as usize];
                    let pixel = whole.pixel_direction(number % size[0], number / size[0]);
                    let thin = camera.pixel_direction(x, y);
                    assert!(
                        thin.distance(pixel) < 1e-12,
                        "{size:?} / {stride} at {x}, {y}"
                    );
                }
            }
        }
        assert!(thinned(&view.camera([8, 8]), &[0; 64], 9).is_none());
    }
}
