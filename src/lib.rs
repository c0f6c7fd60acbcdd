//! Rubber on a rough, hard surface: point masses under a carrier, springs, dampers and Maxwell elements, a rigid
//! cubic-spline profile, stick and slip.
//!
//! The model is that of F. Schulte, J. Neuhaus and W. Sextro, *A mechanical model for the dynamical contact of elastic
//! rough bodies with viscoelastic properties*; equation numbers, as in (7), are that paper's.
//!
//! # One way through
//!
//! ```text
//! scene ──► model ──► integrator ──► contact ──► outputs ──► simulation ──► fmi (the C interface) and the program
//! TOML      links,    one implicit   modes and   forces,     step, event,
//! checked   forces    stage kernel   events      energy      new modes
//! ```
//!
//! An [`element`] stands beside the simulation: it looks the forces of a layer up in a table that was swept of it.
//! `robustness` perturbs scenes and judges their runs, for the program's report and the tests.
//!
//! Each module looks only to its left; [`math`] looks nowhere.
//!
//! ```
//! use asperity::outputs::variables;
//! use asperity::scene::{Path, Scene};
//! use asperity::simulation::{Motion, Simulation, Start};
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
//! simulation.advance(&Motion { duration: 1e-3, u: Path::default(), w: press })?;
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
//! | u, w | `Carrier::u`, `w` | m | displacement of the carrier along x and z; w < 0 presses |
//! | k, Δx | `Layer::masses`, `spacing` | 1, m | number and distance of the masses |
//! | X_i, Z_i | `Model::rest_x`, `rest_z` | m | places of the masses at rest |
//! | m | `Model::mass` | kg | one point mass |
//! | ξ_i - u, ζ_i - w | `State::elongation_x`, `elongation_z` | m | elongation of the links to the carrier |
//! | ẋ_i, ż_i | `State::velocity_x`, `velocity_z` | m/s | velocity of mass i |
//! | c, d | `LinkLaw::stiffness`, `damping` | N/m, N s/m | spring and damper of a link |
//! | c_j, τ_j | `MaxwellRow::stiffness`, `relaxation_time` | N/m, s | Maxwell element, d_j = c_j τ_j |
//! | a_j = e - y_j | `State::maxwell` | m | elongation of a Maxwell element's spring; rows 21, 22 of (13)-(15) |
//! | E_∞, E_j, η | `Material::equilibrium_modulus`, `prony`, `viscosity` | Pa, Pa, Pa s | material form |
//! | ν, ρ | `Material::poisson_ratio`, `density` | 1, kg/m³ | material form |
//! | H, B, A = B Δx | `Layer::thickness`, `width`, `element_area()` | m, m² | material form |
//! | a_T | `Material::shift_factor()` | 1 | shift of all times with temperature (Williams, Landel and Ferry) |
//! | E', E'' | `Material::complex_modulus()` | Pa | storage and loss modulus (2) |
//! | f_x,i, f_z,i | `Forces::on_mass_x`, `on_mass_z` | N | forces of the links on mass i (3), (4) |
//! | F_x, F_z | `Forces::on_carrier_x`, `on_carrier_z` | N | forces of the layer on the carrier |
//! | z_r, s, κ | `SurfacePoint::height`, `slope`, `curvature` | m, 1, 1/m | profile, z_r', z_r'' (5), (9) |
//! | q | `ContactForces::q` | 1 | √(1 + s²) |
//! | g | gap | m | z - z_r(x) |
//! | F_N, F_T | `ContactForces::normal`, `friction()` | N | contact forces along n and against v_t (6), (7) |
//! | T(v_t) | `ContactForces::friction()` | N | friction force in slip, μ F_N + A τ_0 + A τ_f(v_t) |
//! | T(0) | `ContactForces::limit` | N | largest friction force at rest, μ F_N + A τ_0 + A τ_f(v_c) |
//! | μ, A τ_0 + A τ_f(v_c) | `Model::friction_coefficient`, `shear_force` | 1, N | friction law at rest |
//! | A τ_f(v) - A τ_f(v_c) | `RateShear::beyond()` | N | shear strength of rubber, what of it depends on the speed |
//! | σ | `Mode::direction()` | 1 | direction of slip along t |
//! | h, γ, β | `h`, `Tableau::gamma()`, `beta` | s, 1, s | step, coefficient of a stage, γh |
//! | G, K | `Jenkins::force`, `stiffness` | N, N/m | spring of a point-contact element, G = -F_x |
//! | a, y | `Contact` over the approach | m, 1 | minus the separation of an element's carrier; ln of its pressure |
//! | E_in, T, V | `ChannelEnergies::input`, `kinetic_energy`, `elastic_energy` | J | energy balance |

pub mod contact;
pub mod element;
pub mod fmi;
pub mod integrator;
pub mod math;
pub mod model;
pub mod outputs;
#[cfg(feature = "program")]
pub mod robustness;
pub mod scene;
pub mod simulation;
