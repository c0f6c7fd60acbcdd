//! What one computes with scenes: steady sliding, sweeps, fits, calibrations, checks, benchmarks, and their packing as FMUs.
//! Inputs and results are typed, what is written of them is made as text, and long work tells how far it is by a callback
//! whose answer may end it.
//!
//! What is asked for are types that say what each option means, from which the program's arguments are made. It knows
//! nothing else of arguments, and nothing of the terminal, of how pictures are drawn and of the process: its errors speak of
//! options in backquotes, which the program makes flags of.
//!
//! # Modules
//!
//! Each module uses only those named beside it, which stand before it.
//!
//! | module | uses | contents |
//! |---|---|---|
//! | [`decimals`] | | numbers as text: in all their digits, rounded, with prefixes of units |
//! | [`values`] | decimals | values of options as people write them: with units, lists, ranges |
//! | [`html`] | | pages in HTML: templates filled in, tables |
//! | [`picture`] | decimals | pictures as plain data: panels with axes and marks |
//! | [`progress`] | | how far long work is, and how it is ended |
//! | [`implausible`] | decimals | friction and areas of contact that no rubber has |
//! | [`settings`] | | keys set in the text of a file, so that its comments stay |
//! | `error` | progress | why something is not done: what was expected, what was found, and where |
//! | [`uncertainty`] | error | what is not known of a scene, scenes drawn from it, what of it matters |
//! | [`files`] | error, uncertainty | scenes, patches, seals and other files, read |
//! | [`csv`] | decimals, error, files | tables of text with a header, read and written |
//! | [`masses`] | decimals, html, picture | what the masses of a layer do over a run, as arrays, as a picture and as an animation |
//! | [`time_history`] | picture | a run over time as a picture |
//! | [`patch_history`] | decimals, picture, time_history | a run of a patch as a picture |
//! | [`seal_history`] | decimals, picture, time_history | a run of a seal as a picture |
//! | [`stribeck`] | decimals, error, picture, progress, values | friction, film and leak of a seal in steady motion |
//! | [`least_squares`] | decimals, error | a formula's numbers fitted to data, and which of them these determine |
//! | [`friction_law`] | decimals, error, files, least_squares, stribeck | laws of friction fitted to friction in steady motion |
//! | [`tyre`] | decimals, error, files, friction_law, least_squares, picture, progress, values | slip curves of a patch, and tyre models fitted to them |
//! | [`runner`] | progress, values | a scene along its excitation, row by row |
//! | [`steady`] | | steady sliding, solved for as such: contact, friction, heat; Persson's theory |
//! | [`sweep`] | decimals, error, files, implausible, picture, progress, steady, uncertainty, values | friction over speed, load and temperature, as a table |
//! | [`contact`] | decimals, implausible, picture, steady, sweep, values | the contact of a surface in steady sliding |
//! | [`converge`] | contact, decimals, error, picture, steady, sweep, values | whether area and friction depend on spacing, length or chance |
//! | [`calibration`] | csv, decimals, error, files, implausible, picture, progress, settings, steady, sweep, uncertainty, values | free numbers of a scene from measured friction: models, least squares, errors, plans |
//! | [`comparison`] | calibration, decimals, files, picture, sweep | a table of a sweep beside measured friction |
//! | [`friction_map`] | calibration, comparison, picture, sweep | a table's friction over two of its quantities |
//! | [`rank`] | calibration, comparison, csv, decimals, error, files, picture, progress, sweep, uncertainty, values | scenes in the order of their friction, and how sure that is |
//! | [`fit`] | decimals, error, files, picture, values | Prony series and shift factors from measured moduli |
//! | [`material`] | decimals, error, picture, values | moduli of a scene's compound, or stiffnesses of its links, over frequency |
//! | [`surface`] | decimals, files, picture, steady, values | numbers, spectra and power laws of a surface; smoothed, split and made periodic |
//! | [`summary`] | decimals, error, picture, runner, steady | what there is in a scene, a patch, a seal or a table, in lines |
//! | [`run_figures`] | decimals, implausible, summary | forces and friction of a run, what it cost, and what would make it cheaper |
//! | [`robustness`] | | a catalogue of perturbations of a scene, and the judge of perturbed runs |
//! | [`pack`] | decimals, error, files, html, picture, robustness, runner, summary, sweep | scenes, tables, patches and seals as FMUs |
//! | [`motion`] | error, files | the motion that a patch or a seal is moved along |
//! | [`check`] | csv, decimals, error, picture, progress, runner, summary, sweep | elements and patches against what was swept |
//! | [`benchmark`] | csv, decimals, picture, progress, robustness, runner, values | what the runs of a scene cost and how accurate they are |

pub mod benchmark;
pub mod calibration;
pub mod check;
pub mod comparison;
pub mod contact;
pub mod converge;
pub mod csv;
pub mod decimals;
mod error;
pub mod files;
pub mod fit;
pub mod friction_law;
pub mod friction_map;
pub mod html;
pub mod implausible;
#[cfg(test)]
#[path = "../../../src/in_tests.rs"]
mod in_tests;
pub mod least_squares;
pub mod masses;
pub mod material;
pub mod motion;
pub mod pack;
pub mod patch_history;
pub mod picture;
pub mod progress;
pub mod rank;
pub mod robustness;
pub mod run_figures;
pub mod runner;
pub mod seal_history;
pub mod settings;
pub mod steady;
pub mod stribeck;
pub mod summary;
pub mod surface;
pub mod sweep;
pub mod time_history;
pub mod tyre;
pub mod uncertainty;
pub mod values;

pub use error::{Context, Error, ErrorKind};
