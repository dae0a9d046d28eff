#pragma once
// A scene: what the user wants modelled, after units are resolved and every value is checked.
// A table that is absent from the file is absent here (std::optional, empty vector): that physics does not
// exist.
//
// Inside, everything is reduced: lengths in f/mu, times in f/(mu v0), angles in rad. Units exist only at the
// door (reading: scene/read.hpp; writing results: Scales below). The granular tables are SI
// (scene/granular.hpp).

#include "rodwake/core/periodic.hpp"
#include "rodwake/elastic/accuracy.hpp"
#include "rodwake/integrate/method.hpp"
#include "rodwake/medium/dynamic_medium.hpp"
#include "rodwake/rods/body_shape.hpp"
#include "rodwake/rods/couplings.hpp"
#include "rodwake/rods/form.hpp"
#include "rodwake/scene/fit.hpp"
#include "rodwake/scene/granular.hpp"
#include "rodwake/scene/measure.hpp"
#include "rodwake/scene/scan.hpp"
#include "rodwake/scene/tracks.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::scene {

enum class UnitSystem { reduced, si };

inline constexpr double default_bead_radius = 0.4e-3; // m

/// What one reduced unit is worth. [scales] is needed for units = "si" and for any value with a unit.
struct Scales {
    double f_over_mu = 0.0; ///< m, the unit of length
    double v0 = 0.0;        ///< m/s, self-propulsion speed; the unit of time is f_over_mu / v0
    double bead_radius = default_bead_radius; ///< m, what "a" means in "2.2 a"

    bool operator==(const Scales&) const = default;
};

enum class FieldBackend { exact, table, measured, dynamic };
enum class PolarBasis { laplacian, divergence };

/// [medium.table]: for backends that interpolate the field. The exact one has no use for it.
struct FieldTable {
    double tolerance = 1e-8;

    bool operator==(const FieldTable&) const = default;
};

/// [medium.measured]: the displacement field that rods move in with field = "measured". Lengths in f/mu.
struct MeasuredMedium {
    std::string file;                  ///< measure.h5 of `rodwake measure`
    std::optional<double> core;        ///< absent: 4 bead radii of the file
    std::optional<double> edge;        ///< absent: where the measured field ends
    std::optional<double> blend;       ///< absent: 6 bead radii
    std::optional<double> correlation; ///< absent: 0.71 lattice spacings of the file's phi_b
    std::optional<double> smoothing;   ///< absent: by cross-validation
    long samples = 32;
    long seed = 1;

    bool operator==(const MeasuredMedium&) const = default;
};

/// [medium]: the elastic continuum. eta = (lambda_L + mu)/mu = K/mu, coefficient of grad div over mu; xi =
/// mu/(zeta v0).
struct Medium {
    double eta = 1.0; ///< > -1
    double xi = 1.0;  ///< > 0, in f/mu; alpha = 1/xi
    FieldBackend field = FieldBackend::exact;
    std::optional<FieldTable> table;
    std::optional<MeasuredMedium> measured;
    std::optional<medium::DynamicMedium> dynamic; ///< absent: its defaults; only with field = dynamic
    std::optional<PeriodicBox> periodic;          ///< f/mu; absent: infinite plane. See box()
    bool fitted = false; ///< eta and xi come from [fit]; those here mean nothing until then

    bool is_dynamic() const { return field == FieldBackend::dynamic; }
    medium::DynamicMedium memory() const { return dynamic.value_or(medium::DynamicMedium{}); }
    /// The periodic box, whichever key gives it; none: infinite plane.
    std::optional<PeriodicBox> box() const {
        return is_dynamic() ? std::optional<PeriodicBox>(memory().box) : periodic;
    }

    bool operator==(const Medium&) const = default;
};

/// [coupling]: kappa in v0 mu/f, gamma in v0, as written in the scene (polar_basis says which basis).
struct Coupling : rods::Couplings {
    PolarBasis polar_basis = PolarBasis::laplacian;
    double gamma_flow = 0.0; ///< mu/f
    rods::Rows rows;

    bool operator==(const Coupling&) const = default;
};

/// [noise]: white noise on the rods; with both coefficients 0 there is none.
struct Noise {
    double rotational_diffusion = 0.0;    ///< rad^2 mu v0/f
    double translational_diffusion = 0.0; ///< f v0/mu
    long runs = 1;
    std::optional<double> capture_error; ///< runs go on until the capture probability is known so well
    long most_runs = 10'000;             ///< with capture_error: at most so many, `runs` at least
    std::optional<double> time_step;     ///< longest step, f/(mu v0); absent: rods::suitable_time_step
    long seed = 1;

    bool operator==(const Noise&) const = default;
};

/// [body]: of all rods but those with a shape of their own.
struct Body : rods::BodyShape {
    double stall_overlap = rods::RodBodies{}.stall_overlap;
    double mobility_ratio = rods::RodBodies{}.mobility_ratio;

    bool operator==(const Body&) const = default;
};

/// [[rods]]
struct Rod {
    std::vector<double> position;             ///< x, y
    double heading = 0.0;                     ///< rad, counter-clockwise from +x
    std::optional<rods::BodyShape> body = {}; ///< absent: that of [body]

    bool operator==(const Rod&) const = default;
};

enum class RandomShape { square, disc };

/// [rods_random]: rods at random in a square or disc round the origin, in place of [[rods]].
struct RandomRods {
    long count = 100;
    RandomShape shape = RandomShape::square;
    double extent = 0.0;         ///< side of the square or diameter of the disc, f/mu
    double min_separation = 0.0; ///< of two rods, across the sides of the square too, f/mu
    double heading = 0.0;        ///< rad; headings are uniform within `spread` of it
    double spread = 3.14159265358979323846;
    long seed = 1;

    bool operator==(const RandomRods&) const = default;
};

/// The rods it stands for; they depend on its values and on the body alone, and bodies do not overlap. None
/// if they are too crowded.
std::vector<Rod> random_rods(const RandomRods& random, const std::optional<Body>& body);
/// Share of the square or disc that discs of diameter min_separation cover, or the bodies if they cover more
/// of what they may. Up to most_crowding all rods find room.
double crowding(const RandomRods& random, const std::optional<Body>& body);
inline constexpr double most_crowding = 0.3;
/// "square of side 40"
std::string region_of(const RandomRods& random);

/// [rods_run]
struct RodsRun {
    double t_end = 0.0;                      ///< > 0 (resolved)
    std::optional<double> t_end_limit;       ///< where undecided points of a scan end; absent: 1000 t_end
    bool t_end_from_outputs = false;         ///< t_end was not given: it is the last output time
    std::vector<double> output_times;        ///< increasing, within (0, t_end]; ends with t_end (resolved)
    std::optional<double> contact_distance;  ///< stop there; absent: no stop
    std::optional<integrate::Method> method; ///< absent: the one that suits the problem
    rods::Formulation form = rods::Formulation::angle;
    double rtol = 1e-8, atol = 1e-10; ///< atol: rtol / 100 if not given
    double turning_tolerance = 0.0;   ///< errors by far wakes on meshes, mu v0/f; 0: pair by pair
    elastic::Accuracy precision = elastic::Accuracy::full; ///< of the sums over many rods
    long max_steps = 1'000'000;

    bool operator==(const RodsRun&) const = default;
};

/// [rods_order]: order parameters and clusters of the rods in time. Of a bed (order_of_bed) m and s.
struct RodsOrder {
    std::optional<double> link; ///< rods nearer than this are of one cluster, f/mu; absent: bodies that touch
    double from = 0.0;          ///< earlier times do not count in the means, f/(mu v0)
    std::optional<double> block; ///< of time, one independent value for the errors; absent: a tenth of what
                                 ///< counts

    bool operator==(const RodsOrder&) const = default;
};

/// [[field.cuts]]: the field along a line parallel to an axis.
struct Cut {
    std::string along = "x";     ///< "x" or "y": the coordinate that varies
    double at = 0.0;             ///< the other coordinate
    double from = 0.0, to = 0.0; ///< range of the varying coordinate
    long count = 401;

    bool operator==(const Cut&) const = default;
};

/// [field]: the field of one rod at the origin heading along +x, on a grid and along cuts.
struct Field {
    std::vector<double> x, y; ///< [min, max] of the grid; empty: no grid
    long nx = 161, ny = 161;
    std::vector<Cut> cuts;

    bool operator==(const Field&) const = default;
};

/// [[figures]]: what `rodwake plot` draws from the results.
struct Figure {
    std::string name;      ///< file name without ending
    std::string kind;      ///< one of those that `rodwake info --schema` lists
    std::string title;     ///< empty: made from the data
    long cut = 0;          ///< kind cut: index into field.cuts
    std::string component; ///< kinds cut, profile: Ux | Uy, displacement_map: also U, the size; set when read
    bool sqrt_scaled = false;                ///< kinds cut, profile: draw |s|^(1/2) U instead of U
    std::string along = "x";                 ///< kind profile: x | y
    std::string quantity;                    ///< kind series: what is drawn (empty: its first quantity) ...
    std::string against = "phi_b";           ///< ... against what
    std::vector<std::vector<double>> gammas; ///< kind polar_streamlines: a panel for each [gamma1, gamma2]
    long frame = -1;                         ///< kind snapshot: which stored frame, from 0; -1: the last
    std::string colour; ///< kinds snapshot, movie: order | orientation; phase_diagram: outcome or a column
    long fps = 20;      ///< kind movie: frames a second
    std::vector<long> profiles; ///< kind fit: indices into fit.profiles; empty: all
    bool residuals = true;      ///< kind fit: residuals under each panel
    std::string parameter;      ///< kind fit_likelihood; empty: the first of fit.likelihood
    bool cells = false;         ///< kind phase_diagram: outline the cells of the refinement
    bool boundary = true;       ///< kind phase_diagram: draw boundary.csv where it is there
    std::vector<double> slices; ///< kind phase_diagram: values of the third axis, a panel each
    std::string column;         ///< kind scan_curve: of scan.csv; empty: made from the data
    /// Window [min, max]; empty: fit to the data. Granular kinds: m; fit kinds: as profiles; scans: as axes
    std::vector<double> x, y;

    bool operator==(const Figure&) const = default;
};

/// [[variants]]: the rods run again with some keys changed; drawn beside the scene as written.
struct Variant {
    std::string name;             ///< file-name safe
    std::string label;            ///< for the legend; empty: name
    std::vector<std::string> set; ///< "coupling.kappa=-100", as for -s

    bool operator==(const Variant&) const = default;
};

struct Scene {
    std::string path; ///< file it came from
    long schema = 1;
    UnitSystem units = UnitSystem::reduced;
    std::string title;
    std::optional<Scales> scales;
    std::optional<Medium> medium;
    std::optional<Coupling> coupling;
    std::optional<Noise> noise;
    std::optional<Body> body;
    std::optional<RandomRods> rods_random;
    std::vector<Rod> rods; ///< with rods_random those it stands for
    std::optional<RodsRun> rods_run;
    std::optional<RodsOrder> rods_order;
    std::optional<Field> field;
    std::optional<Granular> granular;
    std::optional<Tracks> tracks; ///< in place of granular
    std::optional<Measure> measure;
    std::optional<Fit> fit;
    std::optional<Scan> scan;
    std::vector<Figure> figures;
    std::vector<Variant> variants;

    bool operator==(const Scene&) const = default;
};

/// Of the beads that are measured, a, m: of [granular] or of [tracks].
inline double measured_radius(const Scene& scene) {
    return scene.tracks ? scene.tracks->bead_radius : scene.granular->bead_radius;
}

/// The bodies of the rods; none without [body] and rods with a shape of their own.
rods::RodBodies bodies_of(const Scene& scene);

/// Whether the rods diffuse.
inline bool noisy(const Scene& scene) {
    return scene.noise &&
           (scene.noise->rotational_diffusion > 0.0 || scene.noise->translational_diffusion > 0.0);
}

/// Whether [rods_order] looks at the motile rods of the bed, in SI; else at those of [rods_run].
inline bool order_of_bed(const Scene& scene) { return scene.rods_order && !scene.rods_run && scene.granular; }

inline constexpr double max_outputs = 1e6;
inline constexpr double default_outputs = 200.0;

/// i * interval for i = 1, 2, ... below t_end, then t_end exactly. A last gap below 1e-9 interval is merged.
std::vector<double> output_grid(double interval, double t_end);

/// The interval of which `times` is the grid, if it is one.
std::optional<double> grid_interval(const std::vector<double>& times, double t_end);

} // namespace rodwake::scene
