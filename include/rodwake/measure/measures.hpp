#pragma once
// What is measured of one run, frame by frame: the records that are wanted, and nothing else. Fed with the
// same frames, while a run goes on or from its stored trajectory, it holds the same bits.

#include "rodwake/measure/displacement.hpp"
#include "rodwake/measure/flow.hpp"
#include "rodwake/measure/microrheology.hpp"
#include "rodwake/measure/structure.hpp"

#include <optional>

namespace rodwake::measure {

struct MeasureKeys {
    std::optional<StructureKeys> structure;
    std::optional<MicrorheologyKeys> microrheology;
    std::optional<FlowKeys> flow;
    std::optional<DisplacementKeys> displacement;
    double from = 0.0;               ///< s; earlier frames are passed over
    std::size_t structure_every = 1; ///< frames, counted from the first that is measured

    bool operator==(const MeasureKeys&) const = default;
    /// Whether any frame is needed at all.
    bool any() const { return structure || microrheology || flow || displacement; }
};

class Measures {
public:
    /// Throws InputError for a layout or keys that cannot be measured.
    Measures(const Layout& layout, const MeasureKeys& keys);

    /// Throws RunError for a frame that does not fit the layout (check_frame).
    void add(const Frame& frame);
    /// Frames that were measured.
    std::size_t frames() const { return frames_; }

    std::vector<double> pack() const;
    /// Throws RunError for numbers of another layout or other keys.
    void unpack(std::span<const double> values, const std::string& what);

    const std::optional<StructureRecord>& structure() const { return structure_; }
    const std::optional<MicrorheologyRecord>& microrheology() const { return microrheology_; }
    const std::optional<FlowRecord>& flow() const { return flow_; }
    const std::optional<DisplacementRecord>& displacement() const { return displacement_; }
    /// To move the records out.
    std::optional<StructureRecord>& structure() { return structure_; }
    std::optional<MicrorheologyRecord>& microrheology() { return microrheology_; }
    std::optional<FlowRecord>& flow() { return flow_; }
    std::optional<DisplacementRecord>& displacement() { return displacement_; }

private:
    Layout layout_;
    MeasureKeys keys_;
    std::size_t frames_ = 0;
    std::optional<StructureRecord> structure_;
    std::optional<MicrorheologyRecord> microrheology_;
    std::optional<FlowRecord> flow_;
    std::optional<DisplacementRecord> displacement_;
};

} // namespace rodwake::measure
