#include "pipeline/scan/formats/las/epsg.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace sparsha::pipeline::las {
namespace {

constexpr double kMetre = 1.0, kFoot = 0.3048, kUsFoot = 1200.0 / 3937.0;
constexpr double kBritishFoot = 0.3048007491;  // of 1936

/// No code from `first` to `last` has another unit; some are not assigned.
struct Codes {
  int first, last;
  double metres;
};

// Projections: national grids, the zones of UTM, and those of the BLM.
constexpr Codes kProjections[] = {
    {2056, 2056, kMetre},    {2154, 2154, kMetre},    {2157, 2157, kMetre},    {2180, 2180, kMetre},
    {2193, 2193, kMetre},    {3003, 3004, kMetre},    {3006, 3018, kMetre},    {3034, 3035, kMetre},
    {3067, 3067, kMetre},    {3395, 3395, kMetre},    {3763, 3763, kMetre},    {3812, 3812, kMetre},
    {3857, 3857, kMetre},    {3942, 3950, kMetre},    {4399, 4413, kUsFoot},   {4418, 4433, kUsFoot},
    {4438, 4439, kUsFoot},   {4647, 4647, kMetre},    {5221, 5221, kMetre},    {5513, 5514, kMetre},
    {6328, 6348, kMetre},    {6870, 6870, kMetre},    {7846, 7859, kMetre},    {21781, 21781, kMetre},
    {23028, 23038, kMetre},  {25828, 25838, kMetre},  {26701, 26722, kMetre},  {26901, 26923, kMetre},
    {27700, 27700, kMetre},  {28348, 28358, kMetre},  {28992, 28992, kMetre},  {31254, 31287, kMetre},
    {31370, 31370, kMetre},  {31466, 31469, kMetre},  {32064, 32067, kUsFoot}, {32074, 32077, kUsFoot},
    {32099, 32099, kUsFoot}, {32164, 32167, kUsFoot}, {32601, 32663, kMetre},  {32664, 32667, kUsFoot},
    {32700, 32760, kMetre}};

// Projections with heights; all have one unit for both.
constexpr Codes kWithHeights[] = {{5554, 5556, kMetre},  {5844, 5858, kMetre},  {5945, 5976, kMetre},
                                  {6145, 6176, kMetre},  {6650, 6665, kMetre},  {7401, 7405, kMetre},
                                  {7407, 7407, kUsFoot}, {7411, 7422, kMetre},  {7954, 7956, kMetre},
                                  {8700, 8711, kFoot},   {8712, 8800, kUsFoot}, {8801, 8815, kMetre}};

constexpr Codes kHeights[] = {
    {3855, 3900, kMetre},  {4440, 4458, kMetre},       {5193, 5195, kMetre},  {5214, 5214, kMetre},
    {5237, 5237, kMetre},  {5317, 5317, kMetre},       {5336, 5336, kMetre},  {5597, 5613, kMetre},
    {5614, 5614, kFoot},   {5615, 5621, kMetre},       {5701, 5701, kMetre},  {5702, 5702, kUsFoot},
    {5703, 5753, kMetre},  {5754, 5754, kBritishFoot}, {5755, 5799, kMetre},  {5829, 5843, kMetre},
    {5861, 5874, kMetre},  {5941, 5941, kMetre},       {6130, 6132, kFoot},   {6178, 6187, kMetre},
    {6357, 6357, kMetre},  {6358, 6360, kUsFoot},      {6638, 6647, kMetre},  {6693, 6695, kMetre},
    {6916, 6916, kMetre},  {7446, 7447, kMetre},       {7651, 7652, kMetre},  {7699, 7707, kMetre},
    {7832, 7841, kMetre},  {7888, 7890, kMetre},       {7962, 7979, kMetre},  {8050, 8051, kFoot},
    {8052, 8053, kUsFoot}, {8089, 8089, kMetre},       {8228, 8228, kFoot},   {8266, 8267, kMetre},
    {8357, 8358, kMetre},  {8378, 8378, kMetre},       {8434, 8434, kMetre},  {8675, 8675, kMetre},
    {8690, 8691, kMetre},  {8841, 8841, kMetre},       {8881, 8881, kMetre},  {8897, 8897, kFoot},
    {8904, 8911, kMetre},  {9130, 9130, kMetre},       {9245, 9255, kMetre},  {9274, 9288, kMetre},
    {9303, 9303, kMetre},  {9335, 9335, kMetre},       {9351, 9351, kMetre},  {9389, 9402, kMetre},
    {9451, 9458, kMetre},  {9471, 9471, kMetre},       {9650, 9681, kMetre},  {9721, 9722, kMetre},
    {9923, 9927, kMetre},  {20000, 20000, kMetre},     {20034, 20036, kMetre}};

template <std::size_t N>
double metres_in(const Codes (&table)[N], int code) {
  const auto* const found = std::find_if(std::begin(table), std::end(table),
                                         [&](const Codes& codes) { return code >= codes.first && code <= codes.last; });
  return found == std::end(table) ? 0.0 : found->metres;
}

}  // namespace

double metres_of_unit(int code) {
  switch (code) {
    case 9001:
      return kMetre;
    case 9002:
      return kFoot;
    case 9003:
      return kUsFoot;
    case 9095:
      return kBritishFoot;
    case 1025:
      return 0.001;
    case 1033:
      return 0.01;
    default:
      return 0.0;
  }
}

double metres_of_projection(int code) {
  const double with_heights = metres_in(kWithHeights, code);
  return with_heights > 0.0 ? with_heights : metres_in(kProjections, code);
}

bool is_with_heights(int code) { return metres_in(kWithHeights, code) > 0.0; }

double metres_of_heights(int code) {
  const double with_heights = metres_in(kWithHeights, code);
  return with_heights > 0.0 ? with_heights : metres_in(kHeights, code);
}

bool counts_down(int code) {
  // Caspian, Black Sea, Baltic 1977, mean sea level, low waters, NAVD88 and NGVD29.
  constexpr std::array kDepths{5336, 5612, 5706, 5715, 5861, 5862, 5863, 5864, 5865,
                               5866, 5867, 5873, 6357, 6358, 6359, 8051, 8053};
  return std::find(kDepths.begin(), kDepths.end(), code) != kDepths.end();
}

}  // namespace sparsha::pipeline::las
