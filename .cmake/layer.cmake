# cargobay_layer(<layer> SOURCES ...): the static library cargobay_<layer> and its alias.
# Sources are globbed with CONFIGURE_DEPENDS by the callers: a new file is picked up by the next
# build without touching CMake.
function(cargobay_layer layer)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES")
  set(target cargobay_${layer})
  if(NOT arg_SOURCES)
    # A layer of headers only is still a library: give it one empty translation unit.
    set(arg_SOURCES ${CMAKE_CURRENT_BINARY_DIR}/empty.cpp)
    file(CONFIGURE OUTPUT ${arg_SOURCES} CONTENT "")
  endif()
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(cargobay::${layer} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${layer})
  target_compile_features(${target} PUBLIC cxx_std_20)
  # Nothing reads errno after arithmetic; with it, lrint() and sqrt() are calls, not instructions.
  target_compile_options(${target} PRIVATE -fno-math-errno)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  if(CARGOBAY_FUZZ AND CARGOBAY_SANITIZE)
    # A fuzzer sees where its inputs lead; to other programs this means nothing.
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  cargobay_units(${target} ${arg_SOURCES})
  target_link_libraries(${target}
    PRIVATE $<BUILD_INTERFACE:cargobay_warnings>
    PUBLIC $<BUILD_INTERFACE:cargobay_sanitize>)
endfunction()

# cargobay_units(<target> <source>...): with CMAKE_UNITY_BUILD, as in the presets, compiles these a
# folder at a time, and leaves the other sources of the target alone. If you edit one file over and
# over, configure with -DCMAKE_UNITY_BUILD=OFF; clang-tidy sees each file by itself anyway.
function(cargobay_units target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ARGN)
    cmake_path(GET source PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "${folder}" group)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${group}")
  endforeach()
endfunction()
