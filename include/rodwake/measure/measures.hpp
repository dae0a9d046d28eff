#pragma once
// What is measured of one run, frame by frame: the accumulators that are wanted, and nothing else. Fed with
// the same frames, while a run goes on or from its stored trajectory, it holds the same bits.

#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/state_io.hpp"

#include <any>
#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::measure {

/// Sums over frames that can be written and read back.
template<class T>
concept FrameSums = std::copyable<T> &&
    requires(T sums, const T& same, const Frame& frame, StateWriter& out, StateReader& in) {
    sums.add(frame);
    same.save(out);
    sums.load(in);
};

/// One of them, whichever.
class Accumulator {
public:
    template<class T>
    requires(!std::same_as<T, Accumulator> && FrameSums<T>) explicit Accumulator(T sums)
        : sums_(std::move(sums)), calls_(&calls_of<T>) {}

    void add(const Frame& frame) { calls_->add(sums_, frame); }
    void save(StateWriter& out) const { calls_->save(sums_, out); }
    void load(StateReader& in) { calls_->load(sums_, in); }

    /// The sums themselves. Throws std::bad_any_cast if they are of another type.
    template<FrameSums T>
    T& as() {
        return std::any_cast<T&>(sums_);
    }

private:
    struct Calls {
        void (*add)(std::any&, const Frame&);
        void (*save)(const std::any&, StateWriter&);
        void (*load)(std::any&, StateReader&);
    };
    template<class T>
    static constexpr Calls calls_of = {
        [](std::any& sums, const Frame& frame) { std::any_cast<T&>(sums).add(frame); },
        [](const std::any& sums, StateWriter& out) { std::any_cast<const T&>(sums).save(out); },
        [](std::any& sums, StateReader& in) { std::any_cast<T&>(sums).load(in); }};

    std::any sums_;
    const Calls* calls_;
};

/// Frames are passed over until this rod is so far from its place in the first frame.
struct FromTravel {
    std::size_t rod = 0;
    double distance = 0.0; ///< m; 0: none is passed over
};

class Measures {
public:
    /// Frames before the time `from` (s) are passed over, those that FromTravel names and those without
    /// beads: what is measured in frames is measured of beads. Throws InputError for a layout that is none,
    /// or a rod that is not there.
    Measures(const Layout& layout, double from, const FromTravel& travel = {});

    /// To be measured in every `every`-th frame, counted from the first that is measured. States are written
    /// in the order of these calls.
    void include(std::string name, Accumulator sums, std::size_t every = 1);
    /// Whether any frame is needed at all.
    bool any() const { return !parts_.empty(); }

    /// Throws RunError for a frame that does not fit the layout (check_frame).
    void add(const Frame& frame);
    /// Frames that were measured.
    std::size_t frames() const { return frames_; }
    double from() const { return from_; }
    double from_travel() const { return travel_.distance; }
    const Layout& layout() const { return layout_; }

    std::vector<double> save() const;
    /// Throws RunError for numbers of another layout or other measures.
    void load(std::span<const double> values, const std::string& what);

    /// What was included under this name, null if nothing was.
    Accumulator* find(std::string_view name);
    /// Of how many measured frames it takes one; 0: nothing was included under this name.
    std::size_t stride(std::string_view name) const;

private:
    struct MeasurePart {
        std::string name;
        std::size_t every;
        Accumulator sums;
    };

    Layout layout_;
    double from_;
    FromTravel travel_;
    bool seen_ = false, travelled_ = false; ///< with a distance: any frame; one from that distance on
    double first_x_ = 0.0, first_y_ = 0.0;  ///< of the rod, m
    std::size_t frames_ = 0;
    std::vector<MeasurePart> parts_;
};

/// The sums of all runs under one name, taken out of them.
template<FrameSums T>
std::vector<T> take(std::span<Measures> runs, std::string_view name) {
    std::vector<T> sums;
    for (Measures& run : runs)
        if (Accumulator* found = run.find(name))
            sums.push_back(std::move(found->as<T>()));
    return sums;
}

} // namespace rodwake::measure
