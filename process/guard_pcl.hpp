#ifndef PROCESS_GUARD_PCL_HPP
#define PROCESS_GUARD_PCL_HPP
/* What every bridge to PCL does at its border: nothing that is thrown gets out, and PCL prints nothing. Included first. */

/* Memory goes to and fro between PCL and these files, so Eigen must take it from the same place in both; under AddressSanitizer
 * its headers would choose another one than Debian's PCL did. */
#if defined(__LP64__) && !defined(EIGEN_MALLOC_ALREADY_ALIGNED)
#define EIGEN_MALLOC_ALREADY_ALIGNED 1
#endif
#include <exception>
#include <gio/gio.h>
#include <new>
#include <pcl/console/print.h>

/* Runs work(), which returns bool and may set error. What it throws becomes a G_IO_ERROR: "WHAT: not enough memory". */
template <typename Work> bool pcl_guard(GError **error, const char *what, Work work) noexcept
{
	try {
		pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
		return work();
	} catch (const std::bad_alloc &) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: not enough memory", what);
	} catch (const std::exception &e) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: %s", what, e.what());
	} catch (...) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: PCL failed", what);
	}
	return false;
}

#endif
