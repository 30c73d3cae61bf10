#include "process/guard_pcl.hpp"
extern "C" {
#include "process/import-pcd.h"
}
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

static uint8_t datatype_of(enum cloud_type type)
{
	static const uint8_t types[CLOUD_TYPES] = { pcl::PCLPointField::INT8,
		pcl::PCLPointField::UINT8, pcl::PCLPointField::INT16, pcl::PCLPointField::UINT16,
		pcl::PCLPointField::INT32, pcl::PCLPointField::UINT32, pcl::PCLPointField::INT64,
		pcl::PCLPointField::UINT64, pcl::PCLPointField::FLOAT32,
		pcl::PCLPointField::FLOAT64 };
	return types[type];
}

/* As PCL's reading of the header would have left it. */
static pcl::PCLPointCloud2 empty_cloud(const struct pcd_header *h)
{
	pcl::PCLPointCloud2 cloud;
	for (guint i = 0; i < h->fields->len; i++) {
		const auto &f = g_array_index(h->fields, struct pcd_field, i);
		pcl::PCLPointField field;
		/* PCL has its own idea of fields with the name "_". */
		field.name = "f" + std::to_string(i);
		field.offset = f.offset;
		field.datatype = datatype_of(f.type);
		field.count = f.count;
		cloud.fields.push_back(field);
	}
	cloud.width = h->width;
	cloud.height = h->height;
	cloud.point_step = h->point_bytes;
	cloud.row_step = h->point_bytes * h->width;
	cloud.data.resize(static_cast<size_t>(h->point_bytes) * h->width * h->height);
	return cloud;
}

bool pcd_read_binary(const struct pcd_header *h, const uint8_t *body, pcd_point_func point,
	gpointer user_data, GError **error)
{
	return pcl_guard(error, "PCL", [&] {
		pcl::PCLPointCloud2 cloud = empty_cloud(h);
		pcl::PCDReader reader;
		size_t points = static_cast<size_t>(h->width) * h->height;
		if (reader.readBodyBinary(body, cloud, pcl::PCDReader::PCD_V7,
			    h->data == PCD_COMPRESSED, 0) != 0 ||
			cloud.data.size() != points * h->point_bytes) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
				"its compressed points are damaged");
			return false;
		}
		for (size_t i = 0; i < points; i++)
			point(user_data, cloud.data.data() + i * h->point_bytes);
		return true;
	});
}
