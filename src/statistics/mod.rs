//! Means with error bars, the distance of a picture from a reference, and whether two
//! estimates of a picture agree.

mod agreement;
mod batches;
mod cells;
mod comparison;
mod error_measures;
mod multiple;
mod pyramid;
mod ratio;
mod together;
mod welch;

pub use agreement::{ALPHA, Agreement, Verdict};
pub use batches::{BATCHES, BatchMean};
pub use cells::{LevelTest, WorstCell};
pub use comparison::{
    CellErrors, Comparison, Corrected, Estimate, Excess, LevelResult, Measures, Noise, Outcome, Subject,
    WholeRatio,
};
pub use error_measures::{FLOOR_SHARE, RelativeMse, relative_mse};
pub use ratio::{MARGIN, RatioInterval};
pub use together::PValuesTest;
