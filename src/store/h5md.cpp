#include "rodwake/store/h5md.hpp"

#include "h5md_format.hpp"
#include "hdf5_file.hpp"

#include <limits>
#include <map>

namespace rodwake::store {

namespace {

constexpr hsize_t rows_of_numbers = 1024; ///< in a chunk

void write_integers(Hdf5File& file, const std::string& path, const std::vector<std::int32_t>& values) {
    file.dataset(path, H5T_STD_I32LE, {values.size()}, values.data());
}

void write_numbers(Hdf5File& file, const std::string& path, const std::vector<double>& values) {
    file.dataset(path, H5T_IEEE_F64LE, {values.size()}, values.data());
}

/// Everything that is no number of the frames.
void write_metadata(Hdf5File& file, const FrameLayout& layout, const H5mdInfo& info) {
    const std::vector<std::int32_t> format_version = {1, 1};
    write_attribute(open_group(file.get(), "h5md").get(), "version", format_version);
    write_attribute(open_group(file.get(), "h5md/author").get(), "name", info.author);
    const Hdf5Handle creator = open_group(file.get(), "h5md/creator"),
                     own = open_group(file.get(), "rodwake");
    write_attribute(creator.get(), "name", std::string("rodwake"));
    write_attribute(creator.get(), "version", info.version);
    write_attribute(own.get(), "version", info.version);
    write_attribute(own.get(), "command", info.command);
    write_attribute(own.get(), "seed", H5T_NATIVE_UINT64, &info.seed);
    for (const auto& [name, text] : info.texts)
        write_attribute(own.get(), name, text);

    const Hdf5Handle parameters = open_group(file.get(), "parameters"),
                     kinds = open_group(file.get(), "parameters/kinds"),
                     units = open_group(file.get(), "parameters/units");
    for (const auto& [name, value] : info.parameters)
        write_attribute(parameters.get(), name, value);
    std::int32_t number = 0;
    for (const Species& kind : layout.kinds) {
        write_attribute(kinds.get(), kind.name, H5T_NATIVE_INT32, &number);
        ++number;
    }
    const std::vector<std::pair<std::string, std::string>> si = {
        {"length", "m"}, {"time", "s"}, {"mass", "kg"}, {"velocity", "m/s"}, {"angular_momentum", "kg m^2/s"},
        {"system", "SI"}};
    for (const auto& [what, unit] : si)
        write_attribute(units.get(), what, unit);
    if (layout.rods() > 0)
        write_integers(file, "parameters/rod_of_sphere", layout.rod_of_sphere);
}

} // namespace

struct H5mdWriter::Impl {
    Hdf5File file;
    FrameLayout layout;
    bool deflate;
    std::map<std::string, Hdf5Series> series; ///< by path of the element; before `file` to close
    std::int64_t last_step = std::numeric_limits<std::int64_t>::min();

    Impl(const std::filesystem::path& target, FrameLayout checked_layout, const H5mdInfo& info)
        : file(target), layout(std::move(checked_layout)), deflate(info.deflate) {
        write_metadata(file, layout, info);
        write_integers(file, spheres + "species", layout.species);
        write_numbers(file, spheres + "mass", layout.mass);
        write_numbers(file, spheres + "radius", layout.radius);
        if (layout.rods() > 0)
            write_numbers(file, rods + "mass", layout.rod_mass);
        // The one `step` and the one `time`.
        add_series(spheres + "position/step", {H5T_STD_I64LE, {}, rows_of_numbers, false});
        add_series(spheres + "position/time", {H5T_IEEE_F64LE, {}, rows_of_numbers, false});
        add_bodies(spheres, layout.particles());
        if (layout.rods() > 0) {
            add_bodies(rods, layout.rods());
            add(rods + "orientation", {H5T_IEEE_F64LE, {layout.rods(), 4}, 1, deflate});
            add(rods + "angular_momentum", {H5T_IEEE_F64LE, {layout.rods(), 3}, 1, deflate});
        }
        for (const std::string& name : layout.observables)
            add("observables/" + name, {H5T_IEEE_F64LE, {}, rows_of_numbers, false});
    }

    void add_series(const std::string& path, const Hdf5Series::ElementLayout& rows) {
        series.try_emplace(path, file.get(), path, rows);
    }

    /// An element in time with the common step and time.
    void add(const std::string& element, const Hdf5Series::ElementLayout& rows) {
        add_series(element + "/value", rows);
        for (const std::string name : {"/step", "/time"}) {
            const std::string common = spheres + "position" + name;
            if (element + name != common &&
                H5Lcreate_hard(file.get(), common.c_str(), file.get(), (element + name).c_str(), H5P_DEFAULT,
                               H5P_DEFAULT) < 0)
                throw RunError("HDF5: cannot link " + element + name + hdf5_reason());
        }
    }

    void add_bodies(const std::string& group, hsize_t count) {
        const Hdf5Handle box = open_group(file.get(), group + "box");
        const std::int32_t dimension = 3;
        write_attribute(box.get(), "dimension", H5T_NATIVE_INT32, &dimension);
        std::vector<std::string> boundary;
        for (const bool periodic : layout.periodic)
            boundary.push_back(periodic ? "periodic" : "none");
        write_attribute(box.get(), "boundary", boundary);
        add(group + "position", {H5T_IEEE_F64LE, {count, 3}, 1, deflate});
        add(group + "image", {H5T_STD_I32LE, {count, 3}, 1, deflate});
        add(group + "velocity", {H5T_IEEE_F64LE, {count, 3}, 1, deflate});
        // Always the same, but readers look for it in time: deflated it takes next to nothing.
        add(group + "id", {H5T_STD_I32LE, {count}, 1, true});
        add(group + "box/edges", {H5T_IEEE_F64LE, {3, 3}, rows_of_numbers, false});
    }

    void put(const std::string& element, const void* row) { series.at(element + "/value").append(row); }

    void put_bodies(const std::string& group, std::span<const double> position,
                    std::span<const double> velocity, const std::vector<std::int32_t>& id) {
        const WrappedVectors wrapped = wrap(position, layout);
        const auto& [x, y, z] = layout.box;
        const std::array<double, 9> edges = {x, 0, 0, 0, y, 0, 0, 0, z};
        put(group + "position", wrapped.place.data());
        put(group + "image", wrapped.image.data());
        put(group + "velocity", velocity.data());
        put(group + "id", id.data());
        put(group + "box/edges", edges.data());
    }
};

H5mdWriter::H5mdWriter(const std::filesystem::path& target, FrameLayout layout, const H5mdInfo& info)
    : impl_((Hdf5Guard(), std::make_unique<Impl>(target, checked(std::move(layout)), info))) {}

H5mdWriter::~H5mdWriter() {
    const Hdf5Guard guard;
    impl_.reset();
}

void H5mdWriter::add_frame(const Frame& frame) {
    const Hdf5Guard guard;
    check_frame(impl_->layout, frame, impl_->last_step);
    impl_->series.at(spheres + "position/step").append(&frame.step);
    impl_->series.at(spheres + "position/time").append(&frame.time);
    impl_->put_bodies(spheres, frame.position, frame.velocity, impl_->layout.id);
    if (impl_->layout.rods() > 0) {
        impl_->put_bodies(rods, frame.rod_position, frame.rod_velocity, impl_->layout.rod_id);
        impl_->put(rods + "orientation", frame.rod_orientation.data());
        impl_->put(rods + "angular_momentum", frame.rod_angular_momentum.data());
    }
    for (std::size_t i = 0; i < frame.observables.size(); ++i)
        impl_->put("observables/" + impl_->layout.observables[i], &frame.observables[i]);
    impl_->last_step = frame.step;
}

void H5mdWriter::commit() {
    const Hdf5Guard guard;
    for (auto& [path, series] : impl_->series)
        impl_->file.expect(series.close());
    impl_->series.clear();
    impl_->file.commit();
}

} // namespace rodwake::store
