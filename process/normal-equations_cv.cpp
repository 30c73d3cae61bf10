#include "process/guard_cv.hpp"
#include "process/normal-equations.h"
#include <vector>

static cv::Mat as_matrix(const double *m, size_t rows, size_t columns)
{
	return cv::Mat((int)rows, (int)columns, CV_64F, const_cast<double *>(m));
}

/* Unknowns have units as far apart as metres and seconds: each is scaled to its own information first. */
static bool solve(const double *information, const double *gradient, size_t n, double *ret_step,
	double *ret_covariance)
{
	cv::Mat a = as_matrix(information, n, n).clone(), b = as_matrix(gradient, n, 1).clone(),
		inverse;
	std::vector<double> scale(n);
	for (size_t i = 0; i < n; i++) {
		double d = a.at<double>((int)i, (int)i);
		if (!(d > 0))
			return false;
		scale[i] = 1 / std::sqrt(d);
	}
	for (size_t i = 0; i < n; i++) {
		for (size_t j = 0; j < n; j++)
			a.at<double>((int)i, (int)j) *= scale[i] * scale[j];
		b.at<double>((int)i) *= scale[i];
	}
	if (cv::invert(a, inverse, cv::DECOMP_CHOLESKY) == 0)
		return false;
	cv::Mat x = inverse * b;
	for (size_t i = 0; i < n; i++) {
		ret_step[i] = x.at<double>((int)i) * scale[i];
		for (size_t j = 0; ret_covariance && j < n; j++)
			ret_covariance[i * n + j] =
				inverse.at<double>((int)i, (int)j) * scale[i] * scale[j];
	}
	return true;
}

bool normal_equations_solve(const double *information, const double *gradient, size_t n,
	double *ret_step, double *ret_covariance)
{
	return cv_guard(nullptr, "normal equations",
		[&] { return solve(information, gradient, n, ret_step, ret_covariance); });
}

void normal_equations_eigen(const double *matrix, size_t n, double *ret_values, double *ret_vectors)
{
	cv_guard(nullptr, "eigenvalues", [&] {
		cv::Mat values, vectors;
		cv::eigen(as_matrix(matrix, n, n), values, vectors);
		values.copyTo(as_matrix(ret_values, n, 1));
		vectors.copyTo(as_matrix(ret_vectors, n, n));
		return true;
	});
}
