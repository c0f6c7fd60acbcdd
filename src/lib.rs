//! Rubber on a rough, hard surface: point masses under a carrier, springs, dampers and Maxwell elements, a rigid
//! cubic-spline profile, stick and slip.
//!
//! The model is that of F. Schulte, J. Neuhaus and W. Sextro, *A mechanical model for the dynamical contact of elastic
//! rough bodies with viscoelastic properties*; equation numbers, as in (7), are that paper's.
//!
//! # Modules
//!
//! Each module uses only those named beside it, which stand before it. `docs/theory.md` has the derivations, with the
//! files that hold them; `CONTRIBUTING.md` says which files a change takes.
//!
//! | module | uses | contents |
//! |---|---|---|
//! | [`math`] | | splines, tridiagonal systems, roots, Fourier sums and other numerical methods |
//! | [`tables`] | | what readers of files share: fields, units, ranges, errors; kinds of files with columns, in their canonical form |
//! | [`table`] | tables | tables as the project writes them: a header of keys and values, columns with units, rows |
//! | [`scene`] | math, tables | a scene as data: reading TOML, profiles and materials; parameters; checks and warnings |
//! | [`model`] | math, scene | the mechanical model: links and their forces, contact laws, state, energies, stiffness scales, reduction |
//! | `integrator` | math, model | implicit Runge-Kutta steps, with modes held or set-valued friction: stages, dense output, error, sensitivities |
//! | `contact` | integrator, math, model, scene | the rules of mode changes and the impact, event location, the end-of-step correction |
//! | [`outputs`] | integrator, model, scene | the table of the outputs: names, units, values, derivatives, dependencies |
//! | [`simulation`] | contact, integrator, math, model, outputs, scene | a run: its state, the steps of both methods and their lengths, local regions, the reference run |
//! | [`element`] | math, model, outputs, scene, simulation, table, tables | a point-contact element: the forces of a layer, looked up in a table of a sweep |
//! | [`patch`] | element, math, model, outputs, scene, table, tables | a contact patch: many point-contact elements on a rigid face, in three dimensions |
//! | [`seal`] | element, math, scene, table, tables | a lip with a film of fluid: what rubs and leaks where a seal runs in oil |
//!
//! # Use
//!
//! The names that a program needs most stand at the root: a [`Scene`] is read or made, and [`run`] along its own motion or
//! stepped as a [`Simulation`] by a [`Motion`] at a time, seen through a [`Snapshot`]; a table of its sweep makes an
//! [`Element`], or a [`Patch`] of them, stepped as a [`PatchRun`].
//!
//! ```
//! use asperity::outputs::variables;
//! use asperity::scene::Path;
//! use asperity::simulation::Start;
//! use asperity::{Motion, Scene, Simulation};
//!
//! let text = "
//!     name = 'one mass'
//!     [layer]
//!     masses = 1
//!     spacing = 1e-4
//!     mass = 1e-7
//!     [layer.vertical]
//!     stiffness = 2e3
//!     damping = 8e-3
//!     [surface]
//!     kind = 'flat'
//! ";
//! let scene = Scene::parse(text, "one-mass.toml".as_ref())?;
//! let mut simulation = Simulation::new(&scene, &Start::default())?;
//! let press = Path { rate: -0.01, ..Path::default() };
//! simulation.advance(&Motion { duration: 1e-3, u: Path::default(), w: press, ..Motion::default() })?;
//!
//! let variables = variables(&scene);
//! let mut values = vec![0.0; variables.len()];
//! simulation.evaluate(&variables, &mut values);
//! assert_eq!(variables[1].name, "F_z");
//! // Pressed by 10 µm at 10 mm/s: the spring and the damper.
//! assert!((values[1] - (2e3 * 1e-5 + 8e-3 * 0.01)).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Symbols
//!
//! SI units throughout.
//!
//! | symbol | name in the code | unit | meaning, equation |
//! |---|---|---|---|
//! | u, w | `Carrier::displacement()` | m | displacement of the carrier along x and z; w < 0 presses |
//! | k, Δx | `Layer::masses`, `spacing` | 1, m | number and distance of the masses |
//! | X_i, Z_i | `Model::rest_x`, `rest_z` | m | positions of the masses at rest |
//! | m | `Model::mass` | kg | one point mass |
//! | ξ_i - u, ζ_i - w | `State::elongation_x`, `elongation_z` | m | elongation of the links to the carrier |
//! | ẋ_i, ż_i | `State::velocity_x`, `velocity_z` | m/s | velocity of mass i |
//! | c, d | `LinkLaw::stiffness`, `damping` | N/m, N s/m | spring and damper of a link |
//! | c_j, τ_j | `MaxwellRow::stiffness`, `relaxation_time` | N/m, s | Maxwell element, d_j = c_j τ_j |
//! | K', K'' | `Link::complex_stiffness()` | N/m | storage and loss stiffness of a link |
//! | a_j = e - y_j | `State::maxwell` | m | elongation of a Maxwell element's spring; rows 21, 22 of (13)-(15) |
//! | E_∞, E_j, η | `Material::equilibrium_modulus`, `prony`, `viscosity` | Pa, Pa, Pa s | material form |
//! | ν, ρ | `Material::poisson_ratio`, `density` | 1, kg/m³ | material form |
//! | H, B, A = B Δx | `Layer::thickness`, `width`, `element_area()` | m, m² | material form |
//! | K(q), M = E/(1 - ν²) | `scene::Body::normal()`, `tangential()`, `Material::plane_modulus()` | 1/m, Pa | stiffness of a surface against a wave over the plane modulus |
//! | α, β, ℓ | `Foundation::normal`, `tangential`, `depth` | 1/m, m, m | links and mass fitted to a body |
//! | A_r, μ_h, h'_b | `FineFriction`, `FineBand::gradient_square` | m², 1, 1 | area that touches below the profile's resolution, friction by hysteresis there, and the gradient of a band of waves |
//! | ϑ, κ | `State::flash()`, `FlashKernel` | K, K m²/J | flash temperature of a contact, and its response to heat |
//! | a_T | `Material::shift_factor()` | 1 | shift of all times with temperature (Williams, Landel and Ferry) |
//! | E', E'' | `Material::complex_modulus()` | Pa | storage and loss modulus (2) |
//! | f_x,i, f_z,i | `Forces::on_mass_x`, `on_mass_z` | N | forces of the links on mass i (3), (4) |
//! | M, K, D | `DrivenBody::mass`, `stiffness`, `damping` | kg, N/m, N s/m | carrier that is a body, spring and damper to its drive |
//! | N, P | `Input::Load`, `Input::Pull` | N | normal load (N > 0 presses) and tangential force on a body |
//! | u_d, w_d, R | `Outside::drive`, `drive_force()` | m, N | displacement of the drive, its force on the body |
//! | F_x, F_z | `Forces::on_carrier()` | N | forces of the layer on the carrier |
//! | z_r, s, κ | `SurfacePoint::height`, `slope`, `curvature` | m, 1, 1/m | profile, z_r', z_r'' (5), (9) |
//! | q | `ContactForces::q` | 1 | √(1 + s²) |
//! | g | gap | m | z - z_r(x) |
//! | F_N, F_T | `ContactForces::normal`, `friction()` | N | contact forces along n and against v_t (6), (7) |
//! | T(v_t) | `ContactForces::friction()` | N | friction force in slip, μ F_N + A τ_0 + A τ_f(v_t) |
//! | T(0) | `FrictionLaw::limit()`, `ContactForces::limit` | N | largest friction force at rest, μ F_N + A τ_0 + A τ_f(v_c) |
//! | μ, A τ_0 + A τ_f(v_c) | `FrictionLaw::coulomb`, `shear` | 1, N | friction law at rest |
//! | A τ_f(v_c) | `RateShearLaw::plateau()` | N | shear strength of rubber up to the creep speed v_c |
//! | A τ_f(v) - A τ_f(v_c) | `SlipCurve::excess()` | N | excess of the shear strength in slip over its plateau |
//! | σ | `Mode::direction()` | 1 | direction of slip along t |
//! | h, γ, β | `h`, `Tableau::gamma()`, `beta` | s, 1, s | step, coefficient of a stage, γh |
//! | G, K | `Jenkins::force`, `stiffness` | N, N/m | spring of a point-contact element, G = -F_x |
//! | a, y | `element`'s `Contact` over the approach | m, 1 | point-contact element: approach, minus the separation; ln of the pressure |
//! | P_damper, P_maxwell, P_friction, P_in | `Powers::damper`, … | W | powers of the channels and of the carrier |
//! | E_damper, E_maxwell, E_friction, E_in | `ChannelEnergies::damper`, … | J | their integrals over time |
//! | E_impact | `Energies::impact` | J | energy lost in impacts |
//! | T, V | `kinetic_energy()`, `elastic_energy()` | J | energy balance E_in = Δ(T + V + T_c + V_c) + E_damper + E_maxwell + E_friction + E_impact + E_c |

mod contact;
pub mod element;
#[cfg(test)]
mod in_tests;
mod integrator;
#[doc(hidden)]
pub mod internals;
pub mod math;
pub mod model;
pub mod outputs;
pub mod patch;
pub mod scene;
pub mod seal;
pub mod simulation;
pub mod table;
pub mod tables;

pub use element::Element;
pub use outputs::Snapshot;
pub use patch::{Patch, PatchRun};
pub use scene::Scene;
pub use simulation::{Motion, Simulation, run};
