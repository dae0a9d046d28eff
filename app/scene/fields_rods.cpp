// Field lists of [[rods]], [body] and [rods_run].

#include "fields.hpp"
#include "rodwake/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::scene {

namespace {

using enum Dimension;
using integrate::Method;

/// The ways to say how long a run is and when it is stored, in the order of resolve_run's cases.
constexpr KeyAlternative run_forms[] = {
    {"t_end"}, {"t_end", "output_interval"}, {"t_end", "output_times"}, {"output_times"}};
constexpr int without_t_end = 3;

struct RunTimes {
    std::optional<double> t_end, interval;
    std::vector<double> times;
};

/// Leaves the run as it is if the times are not usable.
void resolve_run(Visitor& v, RodsRun& run, const RunTimes& given, int form) {
    const bool from_outputs = form == without_t_end;
    const double last = given.times.empty() ? 0.0 : given.times.back();
    const double t_end = from_outputs ? last : given.t_end.value_or(0.0);
    if (from_outputs && given.times == std::vector{0.0})
        return v.complain("output_times", "has no entry above 0, so the run has no end: give t_end");
    if (!(t_end > 0.0)) // reported already
        return;
    std::vector<double> times = given.times;
    if (form < 2) {
        const double step = given.interval.value_or(t_end / default_outputs);
        if (!(step <= t_end && t_end / step <= max_outputs))
            return v.complain(
                "output_interval",
                fmt::format("is {} f/(mu v0): must be between t_end/1000000 and t_end = {}", step, t_end));
        times = output_grid(step, t_end);
    } else {
        for (std::size_t i = 0; i < times.size(); ++i)
            if (times[i] > t_end || (i > 0 && times[i] <= times[i - 1]))
                return v.complain("output_times",
                                  fmt::format("entry {} is {} f/(mu v0): times must increase strictly "
                                              "within 0 <= t <= t_end = {}",
                                              i, times[i], t_end));
        if (!times.empty() && times.front() == 0.0)
            times.erase(times.begin()); // the start is stored in any case
        if (times.empty() || times.back() < t_end)
            times.push_back(t_end);
    }
    run.t_end = t_end;
    run.t_end_from_outputs = from_outputs;
    run.output_times = std::move(times);
}

/// Coordinates matter on the scale of f/mu, headings on that of a radian.
double default_atol(double rtol) { return rtol / 100.0; }

void solver_fields(Visitor& v, RodsRun& run) {
    std::optional<double> atol = run.atol == default_atol(run.rtol) ? std::nullopt : std::optional(run.atol);
    v(key("method")
          .doc("CVODES BDF or Adams, ARKODE explicit Runge-Kutta; auto: explicit Runge-Kutta, with the wakes "
               "of "
               "more than 100 rods with bodies held over several steps, or BDF for stiff headings")
          .example("\"bdf\""),
      choice(run.method,
             {{"auto", std::nullopt}, {"bdf", Method::bdf}, {"adams", Method::adams}, {"erk", Method::erk}}));
    v(key("form")
          .doc("form of the equations: heading angle; director, put back to length 1 after each step (bdf, "
               "erk); dae, director with a Lagrange multiplier (bdf)")
          .example("\"angle\""),
      choice(run.form, {{"angle", rods::Formulation::angle},
                        {"director", rods::Formulation::director},
                        {"dae", rods::Formulation::dae}}));
    v(key("rtol").within(1e-13, 1e-1).doc("relative tolerance of the local error").example("1e-8"), run.rtol);
    v(key("atol")
          .above(0.0, 1.0)
          .absent("rtol / 100")
          .doc("absolute tolerance of the local error, reduced units")
          .example("1e-10"),
      atol);
    v.derive([&] {
        if (run.form == rods::Formulation::director && run.method == Method::adams)
            v.complain(
                "form",
                "\"director\" is put back to length 1 after each step, which method \"adams\" does not "
                "allow: set method to \"bdf\", \"erk\" or \"auto\"");
        if (run.form == rods::Formulation::dae && run.method && run.method != Method::bdf)
            v.complain(
                "form",
                "\"dae\" is solved by backward differentiation only: set method to \"bdf\" or \"auto\"");
        run.atol = atol.value_or(default_atol(run.rtol));
    });
    v(key("turning_tolerance")
          .unit(rate)
          .within(0.0, 1e3)
          .doc(
              "far wakes are summed on meshes, with errors of each rod's turning rate below this (0: pair by "
              "pair). Of some thousand rods on the plane in the exact field, 0 <= eta <= 20")
          .example("1e-6"),
      run.turning_tolerance);
    v(key("precision")
          .doc("of sums over 8 rods or more on the plane in the exact field: full (1e-13 of a wake), fine "
               "(1e-7) or single (1e-3, mostly 1e-5)")
          .example("\"fine\""),
      choice(run.precision, {{"full", elastic::Accuracy::full},
                             {"fine", elastic::Accuracy::fine},
                             {"single", elastic::Accuracy::single}}));
    v(key("t_end_limit")
          .unit(time)
          .above(0.0)
          .absent("1000 t_end")
          .doc("with scan.decide: points that are still undecided at this time stay so")
          .example("3e4"),
      run.t_end_limit);
    v(key("max_steps").within(1, 1e12).doc("ceiling on internal steps").example("1000000"), run.max_steps);
}

} // namespace

void fields(Visitor& v, rods::BodyShape& shape) {
    v(key("spheres").within(1, 1000).doc("discs in a row, 1 or 3 and more").example("6"), shape.spheres);
    v(key("length").unit(length).above(0.0).doc("end to end").example("1.25"), shape.length);
    v(key("thick_diameter").unit(length).above(0.0).doc("of the disc at the back").example("0.3"),
      shape.thick_diameter);
    v(key("thin_diameter").unit(length).above(0.0).doc("of the disc in front").example("0.2"),
      shape.thin_diameter);
    v.derive([&] {
        if (const auto fault = rods::fault_of(shape))
            v.complain(fault->option, fault->message);
    });
}

void fields(Visitor& v, Body& body) {
    fields(v, static_cast<rods::BodyShape&>(body));
    v(key("stall_overlap")
          .symbol("s")
          .within(1e-4, 0.5)
          .doc(
              "overlap of two discs, as a share of the sum of their radii, at which a rod that walks head on "
              "against a fixed disc stops; small: hard rods, steps as short as s^(3/2)")
          .example("0.05"),
      body.stall_overlap);
    v(key("mobility_ratio")
          .symbol("b")
          .within(1e-3, 1e3)
          .doc("mobility across the rod over that along it (1: the friction of the substrate has no "
               "direction)")
          .example("1.0"),
      body.mobility_ratio);
}

void fields(Visitor& v, Rod& rod) {
    v(key("position").required().unit(length).items(2, 2).doc("start, [x, y]").example("[0.0, 2.5]"),
      rod.position);
    v(key("heading")
          .symbol("\\theta")
          .unit(angle)
          .doc("start direction, counter-clockwise from +x")
          .example("\"90 deg\""),
      rod.heading);
    v.table(key("body").doc("Shape of this rod where it differs from [body]."), rod.body);
}

void fields(Visitor& v, RandomRods& random, const std::optional<Body>& body) {
    v(key("count").required().within(1, 1e5).doc("number of rods").example("300"), random.count);
    v(key("shape")
          .doc("square: rods start anywhere in it; disc: in the circle within that square")
          .example("\"disc\""),
      choice(random.shape, {{"square", RandomShape::square}, {"disc", RandomShape::disc}}));
    v(key("extent")
          .required()
          .unit(length)
          .above(0.0)
          .doc("side of the square, or diameter of the disc")
          .example("40.0"),
      random.extent);
    v(key("min_separation")
          .unit(length)
          .within(0.0, 1e12)
          .doc("no two rods start nearer, nor across the sides of the square, as in a periodic box of this "
               "side; discs of this diameter may cover 0.3 of the square, or of the disc")
          .example("0.5"),
      random.min_separation);
    v(key("heading")
          .symbol("\\theta")
          .unit(angle)
          .doc("middle of the start directions, counter-clockwise from +x")
          .example("\"90 deg\""),
      random.heading);
    v(key("spread")
          .unit(angle)
          .within(0.0, std::numbers::pi)
          .doc("headings are uniform within this of it to both sides; pi: any")
          .example("\"30 deg\""),
      random.spread);
    v(key("seed").within(0, largest_seed).doc("of the random numbers; --seed replaces it").example("7"),
      random.seed);
    v.derive([&] {
        if (crowding(random, std::nullopt) > most_crowding)
            v.complain("min_separation",
                       fmt::format("is {}: discs of this diameter round {} rods cover {:.2g} of the {}, and "
                                   "may cover {}: fewer rods, a larger extent or a smaller min_separation",
                                   random.min_separation, random.count, crowding(random, std::nullopt),
                                   region_of(random), most_crowding));
        else if (crowding(random, body) > most_crowding)
            v.complain("count",
                       fmt::format("is {}: bodies {} long and {} to {} wide are too many for the {}: fewer "
                                   "rods or a larger extent",
                                   random.count, body->length, body->thin_diameter, body->thick_diameter,
                                   region_of(random)));
    });
}

void fields(Visitor& v, RodsRun& run) {
    const bool with_times = v.wants(run_forms); // up to a million times to look through
    RunTimes given;
    if (with_times) {
        // Written as an interval where the times are a grid; the default grid is left to follow t_end.
        const auto grid = grid_interval(run.output_times, run.t_end);
        if (!run.t_end_from_outputs && run.t_end > 0.0)
            given.t_end = run.t_end;
        if (run.t_end_from_outputs || !grid)
            given.times = run.output_times;
        else if (*grid != run.t_end / default_outputs)
            given.interval = grid;
        v(key("t_end")
              .symbol("t_\\mathrm{end}")
              .unit(time)
              .above(0.0)
              .absent("the last of output_times")
              .doc("end of the run; needed unless output_times are given")
              .example("30.0"),
          given.t_end);
        v(key("output_times")
              .unit(time)
              .within(0.0, 1e12)
              .items(1, static_cast<std::size_t>(max_outputs))
              .doc("times to store, strictly increasing up to t_end; 0 and t_end are stored in any case")
              .example("[10.0, 20.0, 30.0]"),
          given.times);
        v(key("output_interval")
              .unit(time)
              .above(0.0)
              .absent(given.times.empty() ? "t_end / 200" : "")
              .doc("store i * output_interval and t_end; at most 1000000 times")
              .example("0.5"),
          given.interval);
    }
    v(key("contact_distance")
          .unit(length)
          .above(0.0)
          .absent("no stop")
          .doc("stop when two rods are this near; rods that start so are in contact at 0")
          .example("0.1"),
      run.contact_distance);
    solver_fields(v, run);
    if (with_times)
        v.one_form(run_forms, [&](int form) { resolve_run(v, run, given, form); });
}

void fields(Visitor& v, RodsOrder& order) {
    v(key("link")
          .unit(length)
          .above(0.0)
          .absent("rods whose bodies touch; needed without [body]")
          .doc("rods nearer than this, or linked by others that are, are one cluster")
          .example("1.0"),
      order.link);
    v(key("from").unit(time).within(0.0, 1e12).doc("earlier times do not count in the means").example("10.0"),
      order.from);
    v(key("block")
          .unit(time)
          .above(0.0)
          .absent("a tenth of what counts")
          .doc("time that counts as one independent value in standard errors")
          .example("5.0"),
      order.block);
}

rods::RodBodies bodies_of(const Scene& scene) {
    rods::RodBodies bodies;
    const bool own_shapes =
        std::ranges::any_of(scene.rods, [](const Rod& rod) { return rod.body.has_value(); });
    if (!scene.body && !own_shapes)
        return bodies;
    const Body common = scene.body.value_or(Body{});
    bodies.stall_overlap = common.stall_overlap;
    bodies.mobility_ratio = common.mobility_ratio;
    if (own_shapes)
        for (const Rod& rod : scene.rods)
            bodies.shapes.push_back(rod.body.value_or(common));
    else
        bodies.shapes = {common};
    return bodies;
}

std::vector<double> output_grid(double interval, double t_end) {
    const double steps = std::clamp(std::ceil(t_end / interval - 1e-9), 1.0, max_outputs);
    std::vector<double> times(static_cast<std::size_t>(steps));
    for (std::size_t i = 0; i < times.size(); ++i)
        times[i] = static_cast<double>(i + 1) * interval;
    times.back() = t_end;
    return times;
}

std::optional<double> grid_interval(const std::vector<double>& times, double t_end) {
    if (times.empty() || !(times.front() > 0.0) || t_end / times.front() > max_outputs)
        return std::nullopt;
    return output_grid(times.front(), t_end) == times ? std::optional(times.front()) : std::nullopt;
}

} // namespace rodwake::scene
