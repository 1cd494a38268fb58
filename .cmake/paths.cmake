# Where things are installed. Include it before the layers: the library knows where its guard is.
if(CMAKE_CROSSCOMPILING AND CMAKE_INSTALL_PREFIX MATCHES "^/usr/?$" AND NOT CMAKE_INSTALL_LIBDIR)
  # GNUInstallDirs uses Debian's multiarch folder only for native builds.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-multiarch
    OUTPUT_VARIABLE architecture OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(architecture)
    set(CMAKE_INSTALL_LIBDIR lib/${architecture} CACHE PATH "Libraries, below the prefix")
  endif()
endif()
include(GNUInstallDirs)

# The guard is not a command for users, and the library of each architecture starts its own.
set(CARGOBAY_GUARD_FOLDER ${CMAKE_INSTALL_LIBDIR}/cargobay)
set(CARGOBAY_GUARD_INSTALLED ${CMAKE_INSTALL_FULL_LIBDIR}/cargobay/cargobay-guard)
