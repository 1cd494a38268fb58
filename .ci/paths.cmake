# Where things are installed. To be included before the layers: the library knows its guard's place.
if(CMAKE_CROSSCOMPILING AND CMAKE_INSTALL_PREFIX MATCHES "^/usr/?$" AND NOT CMAKE_INSTALL_LIBDIR)
  # GNUInstallDirs takes Debian's folder of an architecture for native builds alone.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-multiarch
    OUTPUT_VARIABLE architecture OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(architecture)
    set(CMAKE_INSTALL_LIBDIR lib/${architecture} CACHE PATH "Libraries, below the prefix")
  endif()
endif()
include(GNUInstallDirs)

# The guard is no command for people, and each architecture's library starts its own.
set(CARGOBAY_GUARD_FOLDER ${CMAKE_INSTALL_LIBDIR}/cargobay)
set(CARGOBAY_GUARD_INSTALLED ${CMAKE_INSTALL_FULL_LIBDIR}/cargobay/cargobay-guard)
