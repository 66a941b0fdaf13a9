# What --version says besides the number: the commit that is built and what the build can do. Written anew only where it
# changes. cmake -DSOURCE=... -DFEATURES=... -DOUT=... -P version_text.cmake
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  set(commit "unknown")  # no clone, as from a tarball
endif()
set(text "// Made by app/version_text.cmake.\n#define SPARSHA_COMMIT \"${commit}\"\n#define SPARSHA_FEATURES \"${FEATURES}\"\n")
set(old "")
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUT} "${text}")
endif()
