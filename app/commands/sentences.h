// What the smaller commands have to say, as complete sentences (--plain).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "haptics/device/device_check.h"
#include "haptics/replay/trace.h"
#include "pipeline/check/check.h"
#include "pipeline/register/register.h"
#include "pipeline/replica/replica.h"
#include "pipeline/replica/whole_replica.h"
#include "pipeline/scan/reader.h"
#include "scene/config/audio.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

[[nodiscard]] std::string check_sentences(const pipeline::CheckResult& check);
[[nodiscard]] std::string device_check_sentences(const haptics::CheckReport& report);
[[nodiscard]] std::string modes_sentences(const std::vector<scene::ModeConfig>& modes);
[[nodiscard]] std::string registration_sentences(const scene::Config& config, const pipeline::Registration& found);
[[nodiscard]] std::string replica_sentences(const pipeline::ReplicaReport& report);
[[nodiscard]] std::string whole_replica_sentences(const pipeline::WholeReplicaReport& report);
[[nodiscard]] std::string scan_sentences(const std::filesystem::path& file, const pipeline::ScanInfo& info);
[[nodiscard]] std::string scene_sentences(const std::filesystem::path& folder, const scene::SceneDescription& scene);
[[nodiscard]] std::string trace_sentences(const haptics::TraceSummary& summary, const std::string& file);
/// "The file a.ply was written.", one a line.
[[nodiscard]] std::string written_sentences(const std::vector<std::filesystem::path>& files);

}  // namespace sparsha::app
