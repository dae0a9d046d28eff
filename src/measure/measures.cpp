#include "rodwake/measure/measures.hpp"

#include <algorithm>

namespace rodwake::measure {

Measures::Measures(const Layout& layout, double from) : layout_(layout), from_(from) { validate(layout); }

void Measures::include(std::string name, Accumulator sums, std::size_t every) {
    parts_.push_back({std::move(name), every, std::move(sums)});
}

void Measures::add(const Frame& frame) {
    check_frame(layout_, frame);
    if (frame.time < from_)
        return;
    for (Part& part : parts_)
        if (frames_ % part.every == 0)
            part.sums.add(frame);
    ++frames_;
}

std::vector<double> Measures::save() const {
    StateWriter out;
    out.put(frames_);
    for (const Part& part : parts_)
        part.sums.save(out);
    return out.take();
}

void Measures::load(std::span<const double> values, const std::string& what) {
    StateReader in(values, what);
    frames_ = in.count();
    for (Part& part : parts_)
        part.sums.load(in);
    in.finish();
}

Accumulator* Measures::find(std::string_view name) {
    const auto found = std::ranges::find(parts_, name, &Part::name);
    return found == parts_.end() ? nullptr : &found->sums;
}

std::size_t Measures::stride(std::string_view name) const {
    const auto found = std::ranges::find(parts_, name, &Part::name);
    return found == parts_.end() ? 0 : found->every;
}

} // namespace rodwake::measure
