#include "session.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/scene/write.hpp"

#include <spdlog/sinks/sink.h>

namespace rodwake::cli {

namespace {

/// The seed of everything random; 0 where nothing is.
std::uint64_t used_seed(const Options& options, const scene::Scene& scene) {
    const long of_scene = scene.granular ? scene.granular->seed : scene.fit ? scene.fit->seed : 0;
    return options.seed.value_or(static_cast<std::uint64_t>(of_scene));
}

/// The run directory, marked before the first other file: whatever fails afterwards, it can be taken over.
store::RunDirectory begun(const Options& options, const scene::Scene& scene) {
    store::RunDirectory directory(output_folder(options), options.force);
    directory.begin(
        store::provenance_json({options.command, scene.path, "unfinished", used_seed(options, scene), 0.0}));
    return directory;
}

void write_medium(store::Hdf5Writer& results, const elastic::Medium& medium, const OutputUnits& units) {
    results.attribute("/medium", "eta", medium.eta);
    results.attribute("/medium", "nu", medium.nu());
    results.attribute("/medium", "alpha", 1.0 / medium.xi);
    results.attribute("/medium", "xi", medium.xi * units.length);
}

void write_header(store::Hdf5Writer& results, const scene::Scene& scene, const OutputUnits& units) {
    results.attribute("/", "schema", std::int64_t{1});
    results.attribute("/", "rodwake_version", build_info().version);
    results.attribute("/", "title", scene.title);
    const bool bed_only = scene.granular && !scene.field && !scene.rods_run;
    results.attribute("/", "units", bed_only ? "si" : units.system);
    results.attribute("/", "length_unit", bed_only ? "m" : units.length_name);
    results.attribute("/", "time_unit", bed_only ? "s" : units.time_name);
    if (scene.medium && !scene.medium->fitted)
        write_medium(results, {scene.medium->eta, scene.medium->xi}, units);
    if (scene.medium && scene.medium->periodic)
        results.attribute("/medium", "periodic", *scene.medium->periodic * units.length);
    if (scene.coupling) {
        const rods::Couplings c = couplings_of(scene);
        results.attribute("/coupling", "kappa", c.kappa);
        results.attribute("/coupling", "gamma1", c.gamma1);
        results.attribute("/coupling", "gamma2", c.gamma2);
    }
}

} // namespace

std::filesystem::path output_folder(const Options& options) {
    return options.output.empty()
               ? std::filesystem::path("results") / std::filesystem::path(options.target).stem()
               : std::filesystem::path(options.output);
}

Session::Session(const Options& given, scene::Scene read)
    : options(given), scene(std::move(read)), directory(begun(given, scene)),
      log(make_logger(given, directory.file("log.txt"))), units(output_units(scene)),
      results(directory.file("result.h5")), start_(std::chrono::steady_clock::now()) {
    log->debug("{}", options.command);
    if (directory.resumed())
        log->info("{}: an earlier run did not finish; taking it up", directory.path().string());
    directory.write("scene.toml", scene::to_toml(scene));
    write_header(results, scene, units);
}

void Session::use_medium(double eta, double xi) {
    fitted_ = scene;
    fitted_->medium->fitted = false;
    fitted_->medium->eta = eta;
    fitted_->medium->xi = xi;
    write_medium(results, {eta, xi}, units);
}

void Session::close(StageEnd end) {
    results.commit();
    write_provenance(end == StageEnd::finished ? "finished"
                                               : (end == StageEnd::failed ? "failed" : "interrupted"));
}

void Session::fail(const std::string& why) const noexcept {
    try {
        write_provenance("failed");
        for (const auto& sink : log->sinks())
            if (sink != log->sinks().front()) // the terminal hears it from main
                sink->log({log->name(), spdlog::level::err, why});
        log->flush();
    } catch (const std::exception&) { // a full disk takes the record too; `unfinished` still stands there
    }
}

void Session::write_provenance(const std::string& status) const {
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    directory.write("provenance.json", store::provenance_json({options.command, scene.path, status,
                                                               used_seed(options, scene), wall}));
}

} // namespace rodwake::cli
