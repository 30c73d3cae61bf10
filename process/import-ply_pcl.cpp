/* PCL's ply_parser tells of each element and property that it meets in the header, and takes a function for each; these put
 * the numbers of an element into one row. Our own reading of the header came before, so that here nothing is new. */
#include "process/guard_pcl.hpp"
extern "C" {
#include "process/import-ply.h"
}
#include <cmath>
#include <cstring>
#include <pcl/io/ply/ply_parser.h>
#include <vector>

namespace ply = pcl::io::ply;
using parser = ply::ply_parser;

namespace
{
struct stop {
};

struct sink {
	const struct ply_header *header;
	ply_row_func row;
	gpointer user_data;
	uint32_t defined = 0; /* elements */
	uint32_t current = 0;
	std::vector<double> values = {};
	size_t at = 0;
	bool list_is_new = false;

	const struct ply_property &property(uint32_t element, size_t i) const
	{
		GArray *elements = header->elements;
		const auto &e = g_array_index(elements, struct ply_element, element);
		return g_array_index(e.properties, struct ply_property, i);
	}

	void begin(uint32_t element)
	{
		current = element;
		at = 0;
	}

	void end()
	{
		if (!row(user_data, current, values.data()))
			throw stop();
	}

	template <typename T> void put(T value, bool packed)
	{
		values[at++] = packed ? cloud_role_get(CLOUD_RGB, CLOUD_F32, &value)
				      : static_cast<double>(value);
	}
};

template <typename T>
void define_scalar(parser::scalar_property_definition_callbacks_type &all, sink &s)
{
	parser::at<T>(all) = [&s](const std::string &, const std::string &name) {
		bool packed = sizeof(T) == 4 && std::is_floating_point<T>::value &&
			      cloud_role_of(name.c_str()) == CLOUD_RGB;
		return std::function<void(T)>([&s, packed](T value) { s.put(value, packed); });
	};
}

template <typename Size, typename T>
void define_list(parser::list_property_definition_callbacks_type &all, sink &s)
{
	parser::at<Size, T>(all) = [&s](const std::string &, const std::string &) {
		return std::make_tuple(std::function<void(Size)>([&s](Size) {
			s.values[s.at] = NAN;
			s.list_is_new = true;
		}),
			std::function<void(T)>([&s](T value) {
				if (s.list_is_new)
					s.values[s.at] = static_cast<double>(value);
				s.list_is_new = false;
			}),
			std::function<void()>([&s] { s.at++; }));
	};
}

template <typename Size>
void define_lists(parser::list_property_definition_callbacks_type &all, sink &s)
{
	define_list<Size, ply::int8>(all, s);
	define_list<Size, ply::int16>(all, s);
	define_list<Size, ply::int32>(all, s);
	define_list<Size, ply::uint8>(all, s);
	define_list<Size, ply::uint16>(all, s);
	define_list<Size, ply::uint32>(all, s);
	define_list<Size, ply::float32>(all, s);
	define_list<Size, ply::float64>(all, s);
}

void define_all(parser &p, sink &s)
{
	parser::scalar_property_definition_callbacks_type scalars;
	parser::list_property_definition_callbacks_type lists;
	define_scalar<ply::int8>(scalars, s);
	define_scalar<ply::int16>(scalars, s);
	define_scalar<ply::int32>(scalars, s);
	define_scalar<ply::uint8>(scalars, s);
	define_scalar<ply::uint16>(scalars, s);
	define_scalar<ply::uint32>(scalars, s);
	define_scalar<ply::float32>(scalars, s);
	define_scalar<ply::float64>(scalars, s);
	define_lists<ply::uint8>(lists, s);
	define_lists<ply::uint16>(lists, s);
	define_lists<ply::uint32>(lists, s);
	p.scalar_property_definition_callbacks(scalars);
	p.list_property_definition_callbacks(lists);
	p.element_definition_callback([&s](const std::string &, std::size_t) {
		uint32_t element = s.defined++;
		return std::make_tuple(std::function<void()>([&s, element] { s.begin(element); }),
			std::function<void()>([&s] { s.end(); }));
	});
}

size_t widest(const struct ply_header *h)
{
	size_t most = 1;
	for (guint i = 0; i < h->elements->len; i++) {
		const auto &e = g_array_index(h->elements, struct ply_element, i);
		most = std::max<size_t>(most, e.properties->len);
	}
	return most;
}
} // namespace

bool ply_read_binary(const char *name, const struct ply_header *h, ply_row_func row,
	gpointer user_data, GError **error)
{
	return pcl_guard(error, name, [&] {
		sink s{ h, row, user_data };
		s.values.assign(widest(h), NAN);
		parser p;
		std::size_t line = 0;
		p.error_callback([&line](std::size_t at, const std::string &) { line = at; });
		define_all(p, s);
		try {
			if (p.parse(name))
				return true;
		} catch (const stop &) {
			return true;
		}
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			line <= h->lines && !s.at ? "line %zu is none that PCL reads"
						  : "its elements do not end where the file does",
			line);
		return false;
	});
}
