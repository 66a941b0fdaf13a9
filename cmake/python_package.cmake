# `python3-sparsha`, the Debian package of `import sparsha` (docs/use/install.md): the component python, and what a system's package has besides.
get_target_property(version sparsha_python SPARSHA_PYTHON_VERSION)
string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" version "${version}")
math(EXPR next "${CMAKE_MATCH_2} + 1")
set(next "${CMAKE_MATCH_1}.${next}")

# Python's own list of what is installed; without RECORD, so that pip leaves its files to dpkg.
set(metadata ${CMAKE_BINARY_DIR}/packaging/python)
file(WRITE ${metadata}/METADATA "Metadata-Version: 2.1\nName: sparsha\nVersion: ${PROJECT_VERSION}\nSummary: ${PROJECT_DESCRIPTION}\nRequires-Dist: numpy\n")
file(WRITE ${metadata}/INSTALLER "debian\n")
install(FILES ${metadata}/METADATA ${metadata}/INSTALLER DESTINATION ${SPARSHA_PYTHON_DIR}/sparsha-${PROJECT_VERSION}.dist-info
  COMPONENT python_system)
install(DIRECTORY examples/python/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-sparsha/examples COMPONENT python_system
  PATTERN __pycache__ EXCLUDE)

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-sparsha)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${version}~), python3 (<< ${next}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "sparsha")  # its examples read the sample scans
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/python/postinst ${PROJECT_SOURCE_DIR}/packaging/python/prerm)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "Sparsha's core as a module of Python 3: raw scans become scenes, layers and
forces on arrays of NumPy, computed by the code of the program.")
