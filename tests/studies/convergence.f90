program study_convergence
  !! Errors of the thick cylinder over basis, degree and mesh, as comma-separated lines; read by convergence.py.
  use, intrinsic :: iso_fortran_env, only: output_unit
  use cylinder_errors, only: cylinder_result, solve_cylinder
  implicit none (type, external)
  integer, parameter :: largest = 5          ! degrees
  integer, parameter :: coarsest(largest) = [4, 4, 2, 2, 1], meshes(largest) = [5, 5, 5, 4, 5]
  character(1), parameter :: bases(2) = ['N', 'L']
  type(cylinder_result) :: found, again
  integer :: b, p, k, mesh, repeat

  write (output_unit, '(a)') 'basis,p,mesh,dofs,energy,l2,seconds'
  do b = 1, size(bases)
    do p = merge(2, 1, bases(b) == 'N'), largest
      do k = 0, meshes(p) - 1
        mesh = coarsest(p)*2**k
        call solve_cylinder(bases(b), p, mesh, found)
        do repeat = 1, 2          ! the shortest of three
          call solve_cylinder(bases(b), p, mesh, again)
          found%seconds = min(found%seconds, again%seconds)
        end do
        if (.not. found%solved) error stop 'the deck was not solved'
        write (output_unit, '(a,3(",",i0),3(",",es12.5))') bases(b), p, mesh, found%dofs, found%energy, found%l2, &
          found%seconds
        flush (output_unit)
      end do
    end do
  end do
end program study_convergence
