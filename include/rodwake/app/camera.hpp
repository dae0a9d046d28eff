#pragma once
// rodwake camera: a bed's frames as a camera's tracks, and the scene that measures them.

#include "rodwake/measure/camera.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace rodwake::app {

struct Filmed {
    std::size_t pictures = 0, spots = 0, images = 0;
    std::filesystem::path tracks, scene; ///< tracks.csv, camera.toml; images in images/000000.png and on
};

/// A camera of the scales of a bed: given what its frames are of.
using CameraFor = std::function<measure::Camera(const measure::Layout&)>;

/// Of a run folder, or a trajectory.h5md. `command` is told in the scene. Throws InputError where there are
/// no frames or fewer than two pictures; RunError if the files cannot be written. Nothing is written once
/// `stop` says so.
Filmed film(const std::filesystem::path& run, const CameraFor& camera_for,
            const std::filesystem::path& folder, const std::string& command,
            const std::function<bool()>& stop);

} // namespace rodwake::app
