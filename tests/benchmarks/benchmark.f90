program benchmark
  !! What the parts of the program cost, as lines for tests/benchmark.
  !! benchmark PROJECT SCRATCH: the project's folder, a folder for files that are written and removed.
  use element_benchmarks, only: measure_solid_kernel, measure_shape_functions, measure_interface_kernel, &
    measure_projection
  implicit none (type, external)
  integer :: dimension, p

  do dimension = 2, 3
    do p = 1, merge(4, 3, dimension == 2)
      call measure_solid_kernel(dimension, p)
    end do
  end do
  do dimension = 2, 3
    do p = 1, 4
      call measure_shape_functions(dimension, p)
    end do
  end do
  do dimension = 2, 3
    do p = 1, 4
      call measure_interface_kernel(dimension, p)
      call measure_projection(dimension, p)
    end do
  end do
end program benchmark
