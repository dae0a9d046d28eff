#include "rodwake/store/gsd.hpp"

#include "gsd_format.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace rodwake::store {

namespace {

template<class T>
constexpr GsdType gsd_type = GsdType::f32;
template<>
constexpr GsdType gsd_type<double> = GsdType::f64;
template<>
constexpr GsdType gsd_type<std::uint32_t> = GsdType::u32;
template<>
constexpr GsdType gsd_type<std::uint64_t> = GsdType::u64;
template<>
constexpr GsdType gsd_type<std::int32_t> = GsdType::i32;
template<>
constexpr GsdType gsd_type<std::int8_t> = GsdType::i8;

template<class T>
std::string_view bytes_as_text(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::vector<float> singles(std::span<const double> values, double unit) {
    std::vector<float> out;
    out.reserve(values.size());
    for (const double value : values)
        out.push_back(static_cast<float>(value / unit));
    return out;
}

} // namespace

/// What is in the file so far: chunks are appended, index and names follow them, the header is filled in
/// last.
struct GsdWriter::Chunks {
    PendingFile& file;
    std::uint64_t frame = 0, end = sizeof(GsdHeader);
    std::vector<GsdEntry> index;
    std::vector<std::string> names;

    explicit Chunks(PendingFile& of) : file(of) { file.write(std::string(sizeof(GsdHeader), '\0')); }

    template<class T>
    void add(const std::string& name, const std::vector<T>& values, std::uint32_t columns = 1) {
        if (values.empty())
            return;
        auto at = std::ranges::find(names, name);
        if (at == names.end())
            at = names.insert(names.end(), name);
        index.push_back({frame, values.size() / columns, static_cast<std::int64_t>(end), columns,
                         static_cast<std::uint16_t>(at - names.begin()),
                         static_cast<std::uint8_t>(gsd_type<T>), 0});
        file.write(bytes_as_text(values));
        end += values.size() * sizeof(T);
    }

    std::uint64_t append(std::string_view content) {
        file.write(content);
        return std::exchange(end, end + content.size());
    }

    void finish() {
        std::ranges::sort(index, [](const GsdEntry& a, const GsdEntry& b) {
            return std::pair(a.frame, a.name) < std::pair(b.frame, b.name);
        });
        if (index.empty())
            index.emplace_back();
        GsdHeader head;
        head.gsd_version = 2U << 16;
        head.schema_version = 1U << 16 | 4U;
        std::strcpy(head.application.data(), "rodwake");
        std::strcpy(head.schema.data(), "hoomd");
        std::string text;
        for (const std::string& name : names)
            text += name + '\0';
        text.resize((text.size() / gsd_name_size + 1) * gsd_name_size, '\0');
        head.index_entries = index.size();
        head.index_location = append(bytes_as_text(index));
        head.names_entries = text.size() / gsd_name_size;
        head.names_location = append(text);
        std::fstream out(file.temporary(), std::ios::binary | std::ios::in | std::ios::out);
        out.write(reinterpret_cast<const char*>(&head), sizeof head);
        out.close();
        if (!out)
            throw RunError(file.temporary().string() + ": the header of the GSD file cannot be written");
    }
};

GsdWriter::GsdWriter(const std::filesystem::path& target, FrameLayout layout, double length_unit)
    : layout_(checked(std::move(layout))), unit_(length_unit), pending_(target) {
    if (!(unit_ > 0.0) || !std::isfinite(unit_))
        throw InputError(
            fmt::format("{}: length unit {}: must be finite and positive", target.string(), unit_));
    chunks_ = std::make_unique<Chunks>(pending_);
}

GsdWriter::~GsdWriter() = default;

/// With the first frame: the others take it from there.
void GsdWriter::add_layout() {
    const std::size_t n = layout_.particles();
    std::vector<float> box = singles(layout_.box, unit_), diameter = singles(layout_.radius, 0.5 * unit_);
    box.resize(6, 0.0F);
    std::vector<std::uint32_t> type(layout_.species.begin(), layout_.species.end());
    std::vector<std::int32_t> body;
    for (std::size_t i = 0, of_rods = 0; i < n; ++i)
        body.push_back(layout_.species[i] == 0 ? -1 : layout_.rod_of_sphere[of_rods++]);
    std::size_t longest = 0;
    for (const Kind& kind : layout_.kinds)
        longest = std::max(longest, kind.name.size() + 1);
    std::vector<std::int8_t> types;
    for (const Kind& kind : layout_.kinds) {
        types.insert(types.end(), kind.name.begin(), kind.name.end());
        types.resize((types.size() / longest + (types.size() % longest != 0)) * longest, 0);
    }
    chunks_->add("configuration/box", box);
    chunks_->add("particles/N", std::vector{static_cast<std::uint32_t>(n)});
    chunks_->add("particles/types", types, static_cast<std::uint32_t>(longest));
    chunks_->add("particles/typeid", type);
    chunks_->add("particles/mass", singles(layout_.mass, 1.0));
    chunks_->add("particles/diameter", diameter);
    chunks_->add("particles/body", body);
}

void GsdWriter::add_frame(const Frame& frame) {
    check_frame(layout_, frame, last_step_);
    if (chunks_->frame == 0)
        add_layout();
    WrappedVectors position = wrap(frame.position, layout_);
    for (std::size_t i = 0; i < position.place.size(); ++i)
        position.place[i] -= 0.5 * layout_.box[i % 3];
    chunks_->add("configuration/step", std::vector{static_cast<std::uint64_t>(frame.step)});
    chunks_->add("particles/position", singles(position.place, unit_), 3);
    chunks_->add("particles/velocity", singles(frame.velocity, unit_), 3);
    chunks_->add("particles/image", position.image, 3);
    chunks_->add("log/time", std::vector{frame.time});
    for (std::size_t k = 0; k < frame.observables.size(); ++k)
        chunks_->add("log/" + layout_.observables[k], std::vector{frame.observables[k]});
    ++chunks_->frame;
    last_step_ = frame.step;
}

void GsdWriter::commit() {
    chunks_->finish();
    pending_.commit();
}

} // namespace rodwake::store
