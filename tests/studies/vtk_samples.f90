program vtk_samples
  !! Result folders on which check_vtk.py compares what VTK shows with the splines themselves: FOLDER/plane and
  !! FOLDER/solid, quarter rings of mixed degrees whose elements tell the place as their stress.
  !!
  !!     vtk_samples FOLDER
  use kinds, only: wp, i8
  use model_data, only: model_type
  use bulk_elements, only: bulk_type
  use element_fields, only: evaluate_element_fields
  use field_output, only: field_output_type
  use result_folder, only: result_folder_type
  use result_frame, only: result_field_type, named_text_type
  use place_element, only: place_element_type
  implicit none (type, external)

  character(500) :: argument

  call get_command_argument(1, argument)
  if (argument == '') error stop 'vtk_samples: which folder?'
  call write_sample(trim(argument)//'/plane', 2, [2, 3, 0])
  call write_sample(trim(argument)//'/solid', 3, [2, 3, 4])

contains

  subroutine write_sample(path, ndm, degree)
    !! Angle along the first direction (clockwise), radius 1..2 along the second, height 0..3 along the third. Two
    !! elements stand one beside the other, the second one with its functions in reverse.
    character(*), intent(in) :: path
    integer, intent(in) :: ndm, degree(3)

    type(model_type), target :: model
    type(bulk_type), target :: bulk
    type(result_folder_type) :: folder
    type(field_output_type) :: output
    type(result_field_type), allocatable :: fields(:)
    type(result_field_type) :: point_fields(2)
    type(named_text_type) :: provenance(1)
    real(wp), allocatable :: u(:, :), ce(:, :), points(:, :)
    real(wp) :: radius
    integer :: nb, a, b, e, i, j, k, id, step, failures

    nb = product(degree + 1)
    model%ndm = ndm
    model%ndf = ndm
    model%nn = 2*nb
    allocate (model%x(ndm, 2*nb), model%w(2*nb), ce(nb, nb), u(ndm, 2*nb))
    do e = 0, 1
      a = e*nb
      do k = 0, degree(3)
        do j = 0, degree(2)
          do i = 0, degree(1)
            a = a + 1
            radius = 1 + real(j, wp)/degree(2)
            model%x(:2, a) = radius*[merge(1, 0, i > 0), merge(1, 0, i < 2)]
            if (e == 1) model%x(:2, a) = [-model%x(2, a), model%x(1, a)]
            if (ndm == 3) model%x(3, a) = 3*real(k, wp)/degree(3)
            model%w(a) = merge(sqrt(0.5_wp), 1.0_wp, i == 1)
          end do
        end do
      end do
      ce = 0
      do b = 1, nb
        ce(merge(b, nb + 1 - b, e == 0), b) = 1
      end do
      call model%mesh%add_element(ndm, degree, [(a, a=nb*e + 1, nb*e + nb)], ce, id)
    end do
    ! the nodes of the second element are numbered in reverse
    model%x(:, nb+1:) = model%x(:, 2*nb:nb+1:-1)
    model%w(nb+1:) = model%w(2*nb:nb+1:-1)
    model%material_of = [1, 1]
    model%body_of = [1, 2]
    allocate (model%materials(1))
    allocate (place_element_type :: model%materials(1)%element)
    model%materials(1)%element%ndm = ndm
    model%materials(1)%element%ndf = ndm

    ! elements without tables and histories
    bulk%table_ptr = [0_i8, 0_i8, 0_i8]
    bulk%hist_ptr = bulk%table_ptr
    allocate (bulk%table(0), bulk%hist(0), bulk%hist_n(0))

    call folder%begin(path)
    provenance(1)%name = 'deck'
    provenance(1)%text = 'written by vtk_samples'
    call output%begin(folder, model%mesh, model%x, model%w, model%material_of, model%body_of, .true., provenance)
    do step = 0, 3
      do a = 1, 2*nb
        do i = 1, ndm
          u(i, a) = 0.05_wp*step*sin(real(7*a + 3*i, wp))
        end do
      end do
      call evaluate_element_fields(model, output%cells, u, u, real(step, wp), 1.0_wp, bulk, fields, failures)
      points = reshape([(0.1_wp*i, i=1, 3*step)], [3, step])
      point_fields(1)%name = 'gap'
      point_fields(1)%values = points(1:1, :)
      point_fields(2)%name = 'normal'
      point_fields(2)%values = points
      call output%write(folder, model%mesh, model%w, step, 0.25_wp*step, u, fields, points, point_fields)
    end do
    if (folder%failed) error stop 'vtk_samples: the folder cannot be written'
    if (output%failed) then
      print '(a)', output%message
      error stop 'vtk_samples: no output'
    end if
    if (failures > 0) error stop 'vtk_samples: an element failed'
  end subroutine write_sample
end program vtk_samples
