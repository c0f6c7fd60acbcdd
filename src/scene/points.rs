//! What the data points of a profile must satisfy, from wherever they come.

/// Periodic ends may differ by rounding: by this part of the peak-to-valley height.
const ROUNDING: f64 = 1.0e-12;

/// The coordinate that is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Z,
}

/// Why points are no profile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PointsRefusal {
    pub(super) axis: Axis,
    /// The point at fault, from 0; `None` where it is their number.
    pub(super) index: Option<usize>,
    pub(super) expected: String,
}

/// Checks that there are enough points, that x rises and that periodic ends meet, and makes these ends exactly equal.
pub(super) fn check(x: &[f64], z: &mut [f64], periodic: bool) -> Result<(), PointsRefusal> {
    check_count(x.len(), periodic)?;
    check_order(x)?;
    if periodic { close(z) } else { Ok(()) }
}

fn check_count(count: usize, periodic: bool) -> Result<(), PointsRefusal> {
    let (least, what) = if periodic { (3, "a periodic profile") } else { (2, "a profile") };
    let expected = format!("at least {least} points for {what}");
    if count >= least { Ok(()) } else { Err(PointsRefusal { axis: Axis::X, index: None, expected }) }
}

fn check_order(x: &[f64]) -> Result<(), PointsRefusal> {
    let Some(before) = x.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
    let (previous, here) = (x[before], x[before + 1]);
    let expected = if previous == here {
        format!("each x once, but the point before has x = {previous:?} too")
    } else {
        format!("a number > {previous:?}, the x of the point before, for x must rise")
    };
    Err(PointsRefusal { axis: Axis::X, index: Some(before + 1), expected })
}

fn close(z: &mut [f64]) -> Result<(), PointsRefusal> {
    let height = peak_to_valley(z);
    let [first, .., last] = z else { return Ok(()) };
    if (*last - *first).abs() > ROUNDING * height {
        let expected = format!("{first:?}, the first height, for a periodic profile ends at the height it starts from");
        return Err(PointsRefusal { axis: Axis::Z, index: Some(z.len() - 1), expected });
    }
    *last = *first;
    Ok(())
}

/// Highest minus lowest, m; 0 of nothing.
pub(super) fn peak_to_valley(heights: &[f64]) -> f64 {
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    (highest - lowest).max(0.0)
}
