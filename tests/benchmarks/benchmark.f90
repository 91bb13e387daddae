program benchmark
  !! What the parts of the program cost, as lines for tests/benchmark.
  !! benchmark PROJECT SCRATCH [p [layers]]: the project's folder, a folder for files that are written and removed; p: only the
  !! shell element of this degree; layers: with points over the thickness.
  use model_benchmarks, only: measure_assembly, measure_system
  use adapter_benchmarks, only: measure_adapters
  use search_benchmarks, only: measure_search
  use element_benchmarks, only: measure_solid_kernel, measure_shell_kernel, measure_layered_shell, measure_shape_functions, &
    measure_interface_kernel, &
    measure_projection
  implicit none (type, external)
  integer :: dimension, p, mesh
  character(1000) :: project, scratch, part

  call get_command_argument(1, project)
  call get_command_argument(2, scratch)
  call get_command_argument(3, part)
  if (scratch == '') error stop 'benchmark PROJECT SCRATCH: two folders are expected'
  if (part /= '') then
    read (part, *) p
    call get_command_argument(4, part)
    if (part == '') call measure_shell_kernel(p)
    if (part /= '') call measure_layered_shell(p)
    stop
  end if

  do dimension = 2, 3
    do p = 1, merge(4, 3, dimension == 2)
      call measure_solid_kernel(dimension, p)
      call measure_assembly(trim(scratch), dimension, 'L', p, merge(24, 6, dimension == 2))
      call measure_assembly(trim(scratch), dimension, 'N', p, merge(24, 6, dimension == 2))
    end do
  end do
  do dimension = 2, 3
    do p = 2, 3
      call measure_adapters(trim(scratch), dimension, p)
    end do
  end do
  do p = 2, 5
    call measure_shell_kernel(p)
    call measure_layered_shell(p)
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
  do p = 2, 5
    call measure_search(2, 10**p)
  end do
  do p = 1, 4
    call measure_search(3, nint(10**(0.5*(p + 1))))
  end do
  do mesh = 1, 3
    call measure_system(trim(project), trim(scratch), mesh)
  end do
end program benchmark
