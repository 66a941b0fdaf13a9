#include "pipeline/images/images.h"

#include "base/error.h"
#include "base/system/library.h"

extern "C" const sparsha::pipeline::Images* sparsha_opencv_images();

namespace sparsha::pipeline {

#if defined(SPARSHA_IMAGES_LIBRARY)

const Images& images() {
  static const Images* const kImages = [] {
    void* const library = system::load_library(SPARSHA_IMAGES_LIBRARY);
    if (library == nullptr)
      throw Error(ErrorKind::failure, {SPARSHA_IMAGES_LIBRARY}, "Sparsha's image functions cannot be loaded",
                  "this file in lib/sparsha beside the program's folder, and OpenCV installed");
    const auto get =
        reinterpret_cast<decltype(&sparsha_opencv_images)>(system::symbol(library, "sparsha_opencv_images"));
    if (get == nullptr)
      throw Error(ErrorKind::failure, {SPARSHA_IMAGES_LIBRARY}, "this file holds none of Sparsha's image functions",
                  "the file that was installed with the program");
    return get();
  }();
  return *kImages;
}

#else

const Images& images() { return *sparsha_opencv_images(); }

#endif

}  // namespace sparsha::pipeline
