#include "pipeline/scan/drop.h"

#include <algorithm>

namespace sparsha::pipeline {
namespace {

template <typename T>
void keep_others(const std::vector<bool>& gone, std::vector<T>& values) {
  if (values.empty()) return;
  std::size_t to = 0;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) values[to++] = values[i];
  }
  values.resize(to);
}

void keep_other_faces(const std::vector<bool>& gone, std::vector<std::array<std::uint32_t, 3>>& faces) {
  if (faces.empty()) return;
  std::vector<std::uint32_t> place(gone.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < gone.size(); ++i) place[i] = gone[i] ? 0 : next++;
  std::erase_if(faces, [&](const auto& face) {
    return std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return gone[v]; });
  });
  for (auto& face : faces) {
    for (std::uint32_t& v : face) v = place[v];
  }
}

}  // namespace

void drop_points(RawScan& scan, const std::vector<bool>& gone) {
  std::size_t before = 0;
  std::size_t seen = 0;
  for (RawStation& station : scan.stations) {
    for (; seen < station.first; ++seen) before += gone[seen] ? 1 : 0;
    station.first -= before;
  }
  keep_other_faces(gone, scan.faces);
  keep_others(gone, scan.points);
  keep_others(gone, scan.rgba);
  keep_others(gone, scan.intensity);
  keep_others(gone, scan.normals);
  for (std::vector<float>& values : scan.values) keep_others(gone, values);
}

}  // namespace sparsha::pipeline
