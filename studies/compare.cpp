#include "studies/compare.h"

#include "core/error.h"
#include "rigs/run_folder.h"

namespace tuft::studies {

std::filesystem::path member_folder(const std::filesystem::path& folder, Approach approach) {
  return folder / (approach == Approach::sph ? "sph" : "dem");
}

std::vector<ComparedRun> compare(const CompareRequest& request) {
  rigs::check_run_folder(request.folder);
  for (const Scene& scene : request.scenes) {
    rigs::check_run_folder(member_folder(request.folder, scene.infill.approach));
    rigs::check_host(scene);
  }

  std::vector<ComparedRun> runs;
  for (const Scene& scene : request.scenes) {
    if (request.stop != nullptr && *request.stop) break;
    rigs::RunRequest run;
    run.scene = scene;
    run.folder = member_folder(request.folder, scene.infill.approach);
    run.stop = request.stop;
    rigs::prepare_run_folder(run.folder, scene);
    if (request.before_run) request.before_run(run);
    runs.push_back({run.folder, rigs::run(run)});
    if (request.after_run) request.after_run(runs.back().summary);
  }
  return runs;
}

}  // namespace tuft::studies
