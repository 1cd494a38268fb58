// The library's version, and its errors.
#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"

extern "C" {

const char* cargobay_version(void) { return CARGOBAY_VERSION; }
uint32_t cargobay_version_number(void) { return CARGOBAY_VERSION_NUMBER; }

const char* cargobay_error_message(void) { return cargobay::c::last_failure(); }

const char* cargobay_error_name(int error) {
  switch (error) {
    case CARGOBAY_OK: return "CARGOBAY_OK";
    case CARGOBAY_ENDED: return "CARGOBAY_ENDED";
    case CARGOBAY_E_ARGUMENT: return "CARGOBAY_E_ARGUMENT";
    case CARGOBAY_E_HANDLE: return "CARGOBAY_E_HANDLE";
    case CARGOBAY_E_STATE: return "CARGOBAY_E_STATE";
    case CARGOBAY_E_THREAD: return "CARGOBAY_E_THREAD";
    case CARGOBAY_E_UNSUPPORTED: return "CARGOBAY_E_UNSUPPORTED";
    case CARGOBAY_E_CONTROL: return "CARGOBAY_E_CONTROL";
    case CARGOBAY_E_CONFIG: return "CARGOBAY_E_CONFIG";
    case CARGOBAY_E_FILE: return "CARGOBAY_E_FILE";
    case CARGOBAY_E_RIGHTS: return "CARGOBAY_E_RIGHTS";
    case CARGOBAY_E_MEMORY: return "CARGOBAY_E_MEMORY";
    case CARGOBAY_E_LIMIT: return "CARGOBAY_E_LIMIT";
    case CARGOBAY_E_SYSTEM: return "CARGOBAY_E_SYSTEM";
    case CARGOBAY_E_NO_PORT: return "CARGOBAY_E_NO_PORT";
    case CARGOBAY_E_BUSY: return "CARGOBAY_E_BUSY";
    case CARGOBAY_E_ACCESS: return "CARGOBAY_E_ACCESS";
    case CARGOBAY_E_PIN: return "CARGOBAY_E_PIN";
    case CARGOBAY_E_UNPLUGGED: return "CARGOBAY_E_UNPLUGGED";
    case CARGOBAY_E_SILENT: return "CARGOBAY_E_SILENT";
    case CARGOBAY_E_UNCONFIRMED: return "CARGOBAY_E_UNCONFIRMED";
    case CARGOBAY_E_MODE: return "CARGOBAY_E_MODE";
    case CARGOBAY_E_STALLED: return "CARGOBAY_E_STALLED";
    case CARGOBAY_E_GUARD: return "CARGOBAY_E_GUARD";
    case CARGOBAY_E_FULL: return "CARGOBAY_E_FULL";
    case CARGOBAY_E_TIMEOUT: return "CARGOBAY_E_TIMEOUT";
    case CARGOBAY_E_NO_FRAME: return "CARGOBAY_E_NO_FRAME";
    case CARGOBAY_E_CANCELLED: return "CARGOBAY_E_CANCELLED";
    case CARGOBAY_E_WHEELS: return "CARGOBAY_E_WHEELS";
    default: return "CARGOBAY_E_?";
  }
}

}  // extern "C"
