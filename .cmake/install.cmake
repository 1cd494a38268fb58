# What is installed where, and the Debian packages that .ci/package.sh makes of it. Included last.
# Each component is a package: library (libcargobay0), development (libcargobay-dev), python
# (python3-cargobay), command (cargobay), web (cargobay-web).
if(NOT PROJECT_IS_TOP_LEVEL OR NOT TARGET cargobay_shared)
  return()
endif()
include(CMakePackageConfigHelpers)

set(CARGOBAY_MAINTAINER "Cargobay maintainers <maintainers@cargobay.example>" CACHE STRING
    "Who answers for the packages")
set(install_dir ${PROJECT_BINARY_DIR}/install)  # files generated for the packages
set(packaging_dir ${PROJECT_SOURCE_DIR}/.ci/debian)

# compressed(<file> <folder> <component> [RENAME <name>]): installs man pages and changelogs as
# Debian requires, reproducibly.
function(compressed file folder component)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "RENAME" "")
  cmake_path(GET file FILENAME name)
  if(arg_RENAME)
    set(name ${arg_RENAME})
  endif()
  file(MAKE_DIRECTORY ${install_dir})
  execute_process(COMMAND gzip -9nc INPUT_FILE ${file} OUTPUT_FILE ${install_dir}/${name}.gz
    COMMAND_ERROR_IS_FATAL ANY)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  install(FILES ${install_dir}/${name}.gz DESTINATION ${folder} COMPONENT ${component})
endfunction()

# The library, and the guard, which stops the robot when the library cannot.
install(TARGETS cargobay_shared EXPORT cargobayTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS cargobay_guard RUNTIME DESTINATION ${CARGOBAY_GUARD_FOLDER} COMPONENT library)

# What is needed to build a program.
file(GLOB headers CONFIGURE_DEPENDS hal/c/cargobay.h hal/c/cargobay.hpp)
install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cargobay)
install(EXPORT cargobayTargets NAMESPACE cargobay:: DESTINATION ${package_dir}
  COMPONENT development)
configure_file(.cmake/cargobayConfig.cmake.in ${install_dir}/cargobayConfig.cmake COPYONLY)
# As long as the library is libcargobay.so.0, nothing is removed from it (docs/abi.md).
write_basic_package_version_file(${install_dir}/cargobayConfigVersion.cmake
  COMPATIBILITY SameMajorVersion)
install(FILES ${install_dir}/cargobayConfig.cmake ${install_dir}/cargobayConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT development)
# Wherever it is installed: cmake --install --prefix does not configure again.
set(pc_prefix ${CMAKE_INSTALL_PREFIX})
if(NOT IS_ABSOLUTE ${CMAKE_INSTALL_LIBDIR})
  file(RELATIVE_PATH pc_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  string(REGEX REPLACE "(.*)/$" "\${pcfiledir}/\\1" pc_prefix ${pc_prefix})
endif()
configure_file(.cmake/cargobay.pc.in ${install_dir}/cargobay.pc @ONLY)
install(FILES ${install_dir}/cargobay.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
set(examples_dir ${CMAKE_INSTALL_DATAROOTDIR}/doc/libcargobay-dev/examples)
file(GLOB examples CONFIGURE_DEPENDS examples/*.c examples/*.cpp)
file(GLOB worlds CONFIGURE_DEPENDS examples/worlds/*.world)
install(FILES ${examples} examples/CMakeLists.txt examples/README.md DESTINATION ${examples_dir}
  COMPONENT development)
file(GLOB loops CONFIGURE_DEPENDS examples/loops/*)
install(FILES ${loops} DESTINATION ${examples_dir}/loops COMPONENT development)
install(FILES ${worlds} DESTINATION ${examples_dir}/worlds COMPONENT development)
install(DIRECTORY examples/rust DESTINATION ${examples_dir} COMPONENT development
  PATTERN .gitignore EXCLUDE PATTERN target EXCLUDE PATTERN Cargo.lock EXCLUDE)

# The command, and what prepares a machine for it.
if(TARGET cargobay)
  install(TARGETS cargobay RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT command)
  file(GLOB pages CONFIGURE_DEPENDS docs/man/*.1 docs/man/*.5)
  list(FILTER pages EXCLUDE REGEX "/cargobay-web\\.1$")
  foreach(page IN LISTS pages)
    string(REGEX MATCH "[0-9]$" section ${page})
    compressed(${page} ${CMAKE_INSTALL_MANDIR}/man${section} command)
  endforeach()
  install(FILES docs/completion/cargobay
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/bash-completion/completions COMPONENT command)
  install(FILES docs/completion/_cargobay
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/zsh/vendor-completions COMPONENT command)
  install(FILES docs/completion/cargobay.fish
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/fish/vendor_completions.d COMPONENT command)
  # The same on every architecture, so not in CMAKE_INSTALL_LIBDIR.
  install(FILES examples/system/60-cargobay.rules DESTINATION lib/udev/rules.d COMPONENT command)
  include(.cmake/serve_template.cmake)
  serve_template(examples/system/cargobay-serve.service ${install_dir}/cargobay-serve@.service)
  install(FILES examples/system/cargobay@.service examples/system/cargobay-serve.service
    ${install_dir}/cargobay-serve@.service DESTINATION lib/systemd/system COMPONENT command)
  set(examples_dir ${CMAKE_INSTALL_DATAROOTDIR}/doc/cargobay/examples)
  install(FILES examples/system/cargobay.toml DESTINATION ${examples_dir} COMPONENT command)
  install(FILES ${worlds} DESTINATION ${examples_dir}/worlds COMPONENT command)
  # Messages, headers and man pages refer readers to these.
  file(GLOB pages CONFIGURE_DEPENDS docs/*.md docs/*.svg docs/*.png)
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/cargobay COMPONENT command)
endif()

# The page in the browser, which `cargobay serve` starts from beside itself.
if(TARGET cargobay_web_program)
  install(TARGETS cargobay_web_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT web)
  compressed(${PROJECT_SOURCE_DIR}/docs/man/cargobay-web.1 ${CMAKE_INSTALL_MANDIR}/man1 web)
endif()

add_subdirectory(hal/python)

set(CPACK_COMPONENTS_ALL library development python)
if(TARGET cargobay)
  list(APPEND CPACK_COMPONENTS_ALL command)
endif()
if(TARGET cargobay_web_program)
  list(APPEND CPACK_COMPONENTS_ALL web)
endif()
set(package_library libcargobay0)
set(package_development libcargobay-dev)
set(package_python python3-cargobay)
set(package_command cargobay)
set(package_web cargobay-web)

set(release 1)  # of the packages of this version
string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, if set
configure_file(${packaging_dir}/changelog.in ${install_dir}/changelog @ONLY)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(package ${package_${component}})
  set(doc_dir ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package})
  install(FILES ${packaging_dir}/copyright DESTINATION ${doc_dir} COMPONENT ${component})
  compressed(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${doc_dir} ${component} RENAME changelog)
  compressed(${install_dir}/changelog ${doc_dir} ${component} RENAME changelog.Debian)
  install(FILES ${packaging_dir}/lintian-overrides RENAME ${package}
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/lintian/overrides COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_NAME cargobay)
set(CPACK_PACKAGE_CONTACT ${CARGOBAY_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SOURCE cargobay)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${release})
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
if(CMAKE_CROSSCOMPILING)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-multiarch
    OUTPUT_VARIABLE multiarch OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(multiarch STREQUAL "aarch64-linux-gnu")
    set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  elseif(multiarch STREQUAL "arm-linux-gnueabihf")
    set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE armhf)
  elseif(multiarch STREQUAL "x86_64-linux-gnu")
    set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE amd64)
  endif()
endif()

# CPack indents the descriptions and puts a full stop on their empty lines.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${package_library})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_MULTIARCH same)
# CPack would write a postinst and a postrm that call ldconfig, although Debian has a trigger for
# it. It leaves files that it is given alone, and skips those that do not exist.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA
  ${packaging_dir}/triggers ${packaging_dir}/none/postinst ${packaging_dir}/none/postrm)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
"real-time control of the iRobot Create (shared library)
Cargobay drives the iRobot Create, the 2006 robot with the Open Interface, from
a computer in its cargo bay. A real-time thread wakes on every 15 ms sensor
frame, estimates the wheel speeds and closes the velocity loop. A virtual
Create, in real or virtual time, replaces a robot.

This package contains the shared library, and the guard process that stops the
robot where the program that drives it dies or hangs.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME ${package_development})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_MULTIARCH same)
set(CPACK_COMPONENT_DEVELOPMENT_DEPENDS library)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"real-time control of the iRobot Create (development files)
Cargobay drives the iRobot Create, the 2006 robot with the Open Interface, from
a computer in its cargo bay. A real-time thread wakes on every 15 ms sensor
frame, estimates the wheel speeds and closes the velocity loop. A virtual
Create, in real or virtual time, replaces a robot.

This package contains the headers for C and C++, the files for CMake and
pkg-config, and examples.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME ${package_python})
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11)")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${packaging_dir}/postinst ${packaging_dir}/prerm)
set(CPACK_COMPONENT_PYTHON_DEPENDS library)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
"real-time control of the iRobot Create (Python package)
Cargobay drives the iRobot Create, the 2006 robot with the Open Interface, from
a computer in its cargo bay. A real-time thread wakes on every 15 ms sensor
frame, estimates the wheel speeds and closes the velocity loop. A virtual
Create, in real or virtual time, replaces a robot.

This package contains the Python package cargobay, and examples.")

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME ${package_command})
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS "cargobay-web")
set(CPACK_DEBIAN_COMMAND_PACKAGE_CONTROL_EXTRA ${packaging_dir}/command/postinst
  ${packaging_dir}/command/prerm ${packaging_dir}/command/postrm)
# rsvg-convert makes PNGs of drawings.
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-numpy, cargobay")
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS "python3-cargobay, librsvg2-bin")
set(CPACK_COMPONENT_COMMAND_DEPENDS library)
set(CPACK_COMPONENT_COMMAND_DESCRIPTION
"real-time control of the iRobot Create (command)
Cargobay drives the iRobot Create, the 2006 robot with the Open Interface, from
a computer in its cargo bay. A real-time thread wakes on every 15 ms sensor
frame, estimates the wheel speeds and closes the velocity loop. A virtual
Create, in real or virtual time, replaces a robot.

This package contains the command cargobay, which brings a robot up, drives,
records and replays, measures timing and serves virtual robots; a udev rule for
serial adapters and GPIO, and systemd units for controllers and for \"cargobay
serve\".")

set(CPACK_DEBIAN_WEB_PACKAGE_NAME ${package_web})
set(CPACK_DEBIAN_WEB_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_WEB_PACKAGE_RECOMMENDS "cargobay")
set(CPACK_COMPONENT_WEB_DESCRIPTION
"real-time control of the iRobot Create (page in the browser)
Cargobay drives the iRobot Create, the 2006 robot with the Open Interface, from
a computer in its cargo bay. A real-time thread wakes on every 15 ms sensor
frame, estimates the wheel speeds and closes the velocity loop. A virtual
Create, in real or virtual time, replaces a robot.

This package contains the program cargobay-web, which \"cargobay serve\" starts:
a page in the browser that shows a robot and steers it, and a server for
Foxglove.")

include(CPack)
