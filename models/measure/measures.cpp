#include "rodwake/measure/measures.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/measure/state_io.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

Measures::Measures(const Layout& layout, double from, const FromTravel& travel)
    : layout_(layout), from_(from), travel_(travel) {
    validate(layout);
    if (travel.distance > 0.0 && travel.rod >= layout.rods)
        throw InputError(
            fmt::format("measure: from_travel is a distance of rod {}, and there are {} rods (from 0)",
                        travel.rod, layout.rods));
}

void Measures::include(std::string name, Accumulator sums, std::size_t every) {
    parts_.push_back({std::move(name), every, std::move(sums)});
}

void Measures::add(const Frame& frame) {
    check_frame(layout_, frame);
    if (travel_.distance > 0.0)
        if (const RodPosition& rod = frame.rods[travel_.rod]; rod.seen()) {
            if (!seen_) {
                first_x_ = rod.x;
                first_y_ = rod.y;
            }
            seen_ = true;
            travelled_ = travelled_ || std::hypot(rod.x - first_x_, rod.y - first_y_) >= travel_.distance;
        }
    const bool early = frame.time < from_ || (travel_.distance > 0.0 && !travelled_);
    if (early || frame.x.empty()) // of a film: rods alone
        return;
    for (MeasurePart& part : parts_)
        if (frames_ % part.every == 0)
            part.sums.add(frame);
    ++frames_;
}

std::vector<double> Measures::save() const {
    if (layout_.all_beads > 0)
        throw RunError("measure: sums over tracks are not stored: they are recomputed from the file");
    StateWriter out;
    out.put(frames_);
    if (travel_.distance > 0.0)
        for (const double value : {seen_ ? 1.0 : 0.0, travelled_ ? 1.0 : 0.0, first_x_, first_y_})
            out.put(value);
    for (const MeasurePart& part : parts_)
        part.sums.save(out);
    return out.take();
}

void Measures::load(std::span<const double> values, const std::string& what) {
    StateReader in(values, what);
    frames_ = in.count();
    if (travel_.distance > 0.0) {
        seen_ = in.count() > 0;
        travelled_ = in.count() > 0;
        first_x_ = in.get();
        first_y_ = in.get();
    }
    for (MeasurePart& part : parts_)
        part.sums.load(in);
    in.finish();
}

Accumulator* Measures::find(std::string_view name) {
    const auto found = std::ranges::find(parts_, name, &MeasurePart::name);
    return found == parts_.end() ? nullptr : &found->sums;
}

std::size_t Measures::stride(std::string_view name) const {
    const auto found = std::ranges::find(parts_, name, &MeasurePart::name);
    return found == parts_.end() ? 0 : found->every;
}

void StateWriter::put(std::span<const double> values) {
    put(values.size());
    values_.insert(values_.end(), values.begin(), values.end());
}

std::span<const double> StateReader::take(std::size_t length) {
    if (length > values_.size() - at_)
        throw RunError(
            fmt::format("{}: {} numbers missing at its end", what_, length - (values_.size() - at_)));
    const auto part = values_.subspan(at_, length);
    at_ += length;
    return part;
}

double StateReader::get() { return take(1)[0]; }

std::size_t StateReader::count() {
    const double value = get();
    if (!(value >= 0.0 && value < 0x1p53 && value == std::floor(value)))
        throw RunError(fmt::format("{}: {} where a count is expected", what_, value));
    return static_cast<std::size_t>(value);
}

std::vector<double> StateReader::array() {
    const auto part = take(count());
    return {part.begin(), part.end()};
}

std::vector<double> StateReader::array(std::size_t length) {
    std::vector<double> values = array();
    if (values.size() != length)
        throw RunError(fmt::format("{}: {} values where {} are expected", what_, values.size(), length));
    return values;
}

void StateReader::finish() const {
    if (at_ != values_.size())
        throw RunError(fmt::format("{}: {} numbers too many", what_, values_.size() - at_));
}

} // namespace rodwake::measure
