#ifndef PROCESS_E57_XML_H
#define PROCESS_E57_XML_H
/* The XML of an E57 file (e57.h), found by the file's header, which is checked on the way. */
#include "process/e57-pages.h"
#include <libxml/tree.h>

/* Has a root. NULL: errors as import.h says. Caller frees with xmlFreeDoc. */
xmlDoc *e57_xml_read(e57_pages *pages, import_source *file, GError **error);

#endif
